// How the state of a simulation becomes bytes and is read back: by cereal, in little-endian order.
//
// A class whose state is saved has one function for both ways,
//   template <class Archive> void serialize(Archive& archive) { archive(first_, second_); }
// which names what later steps depend on, and on reading renews what follows from it.
#pragma once

#include <Eigen/Core>
#include <cereal/archives/portable_binary.hpp>
#include <cereal/types/array.hpp>
#include <cereal/types/optional.hpp>
#include <cereal/types/string.hpp>
#include <cereal/types/variant.hpp>
#include <cereal/types/vector.hpp>

namespace Eigen {

/// Vectors and matrices of fixed size, column by column.
template <class Archive, class Scalar, int Rows, int Columns, int Options>
void serialize(Archive& archive, Matrix<Scalar, Rows, Columns, Options>& matrix) {
  static_assert(Rows != Dynamic && Columns != Dynamic);
  archive(cereal::binary_data(matrix.data(), sizeof(Scalar) * Rows * Columns));
}

}  // namespace Eigen

namespace kappaflow {

using StateWriter = cereal::PortableBinaryOutputArchive;
using StateReader = cereal::PortableBinaryInputArchive;

/// To write in any machine's order of bytes what any other reads.
inline StateWriter::Options little_endian() {
  return StateWriter::Options::LittleEndian();
}

}  // namespace kappaflow
