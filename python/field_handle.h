// What Python holds of a field.
#pragma once

#include <memory>

#include "core/errors.h"
#include "surface/field/field.h"

namespace kappaflow::python {

/// A field of its own, or one that a velocity method was lent for a call.
class FieldHandle {
 public:
  explicit FieldHandle(std::shared_ptr<const Field> field) : field_(std::move(field)) {}

  /// Throws InvalidInput where it was lent and is not any more.
  std::shared_ptr<const Field> get() const {
    if (!field_) throw InvalidInput("the field of a velocity method is there for the time of its call only");
    return field_;
  }
  /// At the end of the call that it was lent for.
  void take_back() { field_ = nullptr; }

 private:
  std::shared_ptr<const Field> field_;
};

}  // namespace kappaflow::python
