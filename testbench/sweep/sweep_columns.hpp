#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "testbench/sweep/sweep_points.hpp"

namespace testbench {

/// What a column of a sweep's table is. Names are unique within a table.
struct SweepColumn {
  std::string name;
  std::string section;  ///< input, chosen, result, derived, constraint
  std::string unit;
  std::string meaning;
};

/// The results of a run: numbers of its statistics file, named by their path in it, after rates and
/// utilisations made of them. What the sweep set is not among them.
nlohmann::ordered_json results_of(const nlohmann::ordered_json& statistics);

/// Whether a result belongs to one kernel: tables have those on request, since there are thousands.
bool is_of_kernel(const std::string& result);

/// Throws InputError if a constraint or a derived column names what is neither a parameter that the sweep
/// sets, or of the chip, nor a result; or if a derived column has the name of another column.
void require_columns(const Sweep& sweep);

/// Unit and meaning of the columns of the table of sweep_csv(), in its order.
std::vector<SweepColumn> describe_columns(const Sweep& sweep, const std::vector<std::string>& chosen,
                                          const std::vector<std::string>& results);

/// column,section,unit,meaning: a column of the table a line; no unit for a number that has none.
std::string columns_csv(const std::vector<SweepColumn>& columns);

}  // namespace testbench
