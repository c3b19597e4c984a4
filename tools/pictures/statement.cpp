#include "tools/pictures/statement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace kappaflow {
namespace {

constexpr double kDigits = 1000;  // numbers from it to its square are written out

/// A digit more than measurements have: 1.001 is not 1.
std::string bound_text(double limit) {
  return fmt::format("{:.4g}", limit);
}

/// A share of the way to a limit: value/limit where both are above 0.
double share_of(double value, double limit) {
  if (value <= 0) return value <= limit ? 0 : std::numeric_limits<double>::infinity();
  return limit > 0 ? value / limit : std::numeric_limits<double>::infinity();
}

}  // namespace

double Check::excess() const {
  if (std::isnan(value)) return std::numeric_limits<double>::infinity();
  return std::max(std::isfinite(high) ? share_of(value, high) : 0,
                  std::isfinite(low) ? share_of(low, value) : 0);
}

std::string Check::value_text() const {
  const bool many_digits = std::abs(value) >= kDigits && std::abs(value) < kDigits * kDigits;
  return std::isnan(value) ? "-" : many_digits ? fmt::format("{:.0f}", value) : fmt::format("{:.3g}", value);
}

std::string Check::limit_text() const {
  const bool above = std::isfinite(low), below = std::isfinite(high);
  const std::string limit = above && below ? fmt::format("{} to {}", bound_text(low), bound_text(high))
                            : above        ? fmt::format("≥ {}", bound_text(low))
                                           : fmt::format("≤ {}", bound_text(high));
  return limit_from.empty() ? limit : fmt::format("{} ({})", limit, limit_from);
}

Check at_most(std::string what, double value, double limit, std::string limit_from) {
  return {.what = std::move(what), .value = value, .high = limit, .limit_from = std::move(limit_from)};
}

Check at_least(std::string what, double value, double limit, std::string limit_from) {
  return {.what = std::move(what), .value = value, .low = limit, .limit_from = std::move(limit_from)};
}

std::size_t Statement::cases_that_hold() const {
  return static_cast<std::size_t>(std::ranges::count_if(checks, &Check::holds));
}

const Check& Statement::decisive() const {
  return *std::ranges::max_element(checks, {}, &Check::excess);
}

Statement judged(const Claim& claim, std::vector<Check> checks) {
  Statement result{claim.source, claim.statement, std::move(checks), Verdict::holds, claim.reason};
  const std::size_t hold = result.cases_that_hold();
  if (hold < result.checks.size())
    result.verdict = hold == 0 ? Verdict::does_not_hold : Verdict::under_conditions;
  return result;
}

std::string verdict_text(Verdict verdict) {
  switch (verdict) {
    case Verdict::holds:
      return "holds";
    case Verdict::under_conditions:
      return "holds under conditions";
    case Verdict::too_coarse:
      return "too coarse to tell";
    default:
      return "does not hold";
  }
}

std::string tally(const std::vector<const Statement*>& statements) {
  const auto count = [&](Verdict verdict) {
    return std::ranges::count(statements, verdict, &Statement::verdict);
  };
  if (statements.empty()) return "no statements";
  std::string text = fmt::format("{} of {} statement{} hold{}", count(Verdict::holds), statements.size(),
                                 statements.size() == 1 ? "" : "s", statements.size() == 1 ? "s" : "");
  for (const auto& [verdict, one, many] :
       {std::tuple{Verdict::under_conditions, "holds under conditions", "hold under conditions"},
        std::tuple{Verdict::does_not_hold, "does not hold", "do not hold"},
        std::tuple{Verdict::too_coarse, "is too coarse to tell", "are too coarse to tell"}})
    if (count(verdict) > 0) text += fmt::format(", {} {}", count(verdict), count(verdict) == 1 ? one : many);
  return text;
}

}  // namespace kappaflow
