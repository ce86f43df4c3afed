#pragma once

#include <string>
#include <vector>

#include "model/config/chip_config.hpp"

namespace testbench {

enum class VariationKind : std::uint8_t {
  lower,        ///< by a share of the value
  higher,       ///< by a share of the value
  alternative,  ///< another value of a choice, or the least that is more than nothing
};

/// A chip with one parameter changed.
struct Variation {
  std::string key;
  VariationKind kind;
  std::string value;      ///< as `--set` takes it
  bool changes_requests;  ///< what the firmware asks of its machine may be another (model::Effect::stream)
  model::ChipConfig chip;
};

/// A change that was left out, and why, in a line.
struct LeftOut {
  std::string key;
  std::string reason;
};

struct Variations {
  std::vector<Variation> list;
  std::vector<LeftOut> left_out;
};

/// Every parameter of the chip whose key begins with one of `only` (all, if there is none), in the order of
/// the table: a number less and more by `share`, every other value of a choice. An integer changes by no less
/// than its step; one that must be a multiple or a power of something by a factor of two, if it must. A
/// number of cycles that is 0 has 1 as its alternative; of other zeros there is no share. Left out is what
/// leaves the parameter's range, and a chip that cannot be.
Variations variations_of(const model::ChipConfig& chip, double share, const std::vector<std::string>& only);

}  // namespace testbench
