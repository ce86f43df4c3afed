#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "testbench/film/chart.hpp"
#include "testbench/paper/fastest.hpp"

/// What `csx600 reproduce --fastest` prints.
namespace testbench {

std::string fastest_text(const std::vector<FastestFigures>& figures, const ImageDistance& distance);
nlohmann::ordered_json fastest_json(const std::vector<FastestFigures>& figures, const ImageDistance& distance,
                                    const RenderOptions& options);
BarChart fastest_chart(const std::vector<FastestFigures>& figures);

}  // namespace testbench
