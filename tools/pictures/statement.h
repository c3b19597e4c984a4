// Statements, the measured numbers that they are held against, and what follows.
#pragma once

#include <limits>
#include <string>
#include <vector>

namespace kappaflow {

/// too_coarse: of a smaller variant that does not meet a limit which is the whole one's.
enum class Verdict { holds, under_conditions, does_not_hold, too_coarse };

/// What is claimed, in words.
struct Claim {
  std::string source;  ///< who says it and where
  std::string statement;
  std::string reason;  ///< why it should hold, or what was measured
};

/// A measured number that must lie in [low, high] for one of the cases that a statement is about; NaN does
/// not.
struct Check {
  std::string what;  ///< the case; empty where there is only one
  double value = 0;
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
  std::string limit_from = {};  ///< where the limit is another measurement's: "half of total's"

  bool holds() const { return value >= low && value <= high; }
  /// How far it is from its limits: above 1 beyond them, 0 as far from them as can be.
  double excess() const;
  std::string value_text() const;  ///< three digits
  std::string limit_text() const;  ///< "≤ 0.05", "≥ 0.9", "0.9 to 1.1", with limit_from behind it
};
Check at_most(std::string what, double value, double limit, std::string limit_from = {});
Check at_least(std::string what, double value, double limit, std::string limit_from = {});

/// A claim beside what was measured.
struct Statement {
  std::string source;  ///< who says it and where
  std::string statement;
  std::vector<Check> checks;  ///< one or more
  Verdict verdict = Verdict::does_not_hold;
  std::string reason;  ///< why it should hold, or what was measured

  std::size_t cases_that_hold() const;
  /// Of the checks the one that is nearest to its limit or furthest beyond it, the first of them if several.
  const Check& decisive() const;
};
/// holds where all checks do, does_not_hold where none does, else under_conditions.
Statement judged(const Claim& claim, std::vector<Check> checks);

/// "holds", "holds under conditions", "does not hold", "too coarse to tell".
std::string verdict_text(Verdict verdict);

/// "2 of 3 statements hold, 1 does not hold": those verdicts that there are.
std::string tally(const std::vector<const Statement*>& statements);

}  // namespace kappaflow
