#include "testbench/validation/validation.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace validation_test {

using testbench::Figure;
using testbench::Published;
using testbench::Validation;

Figure figure(double model, Published kind, double low, double high) {
  Figure figure;
  figure.what = "a, \"b\"";
  figure.unit = "GFLOPS";
  figure.chip = "csx600";
  figure.model = model;
  figure.kind = kind;
  figure.published_low = low;
  figure.published_high = high;
  figure.source = "a source";
  return figure;
}

TEST(Validation, ErrorIsFromTheNearestPublishedValue) {
  EXPECT_DOUBLE_EQ(figure(30, Published::value, 25, 25).error_percent(), 20);
  EXPECT_DOUBLE_EQ(figure(20, Published::value, 25, 25).error_percent(), -20);
  EXPECT_DOUBLE_EQ(figure(300, Published::value, 292, 308).error_percent(), 0);
  EXPECT_DOUBLE_EQ(figure(146, Published::value, 292, 308).error_percent(), -50);
  EXPECT_DOUBLE_EQ(figure(462, Published::value, 292, 308).error_percent(), 50);
}

TEST(Validation, BoundsAreMissedOnOneSideOnly) {
  EXPECT_DOUBLE_EQ(figure(3, Published::at_least, 2, 2).error_percent(), 0);
  EXPECT_DOUBLE_EQ(figure(1, Published::at_least, 2, 2).error_percent(), -50);
  EXPECT_DOUBLE_EQ(figure(1, Published::at_most, 2, 2).error_percent(), 0);
  EXPECT_DOUBLE_EQ(figure(3, Published::at_most, 2, 2).error_percent(), 50);
}

TEST(Validation, ReportsHoldEveryFigure) {
  Validation validation;
  validation.figures = {figure(30, Published::value, 25, 25), figure(300, Published::value, 292, 308),
                        figure(1.5, Published::at_least, 2, 2), figure(0.25, Published::at_most, 0.5, 0.5)};
  validation.figures[0].note = "why it is off";
  validation.figures[1].note = "never said";
  validation.shares = {{"a run", "csx600", {{"poly", 75}, {"stolen", 25}}}};
  validation.transfers = {{96, 80, 56, 6e8, 5e8}};
  EXPECT_EQ(testbench::validation_csv(validation),
            "what,unit,chip,model,published_low,published_high,published_kind,error_percent,source\n"
            "\"a, \"\"b\"\"\",\"GFLOPS\",csx600,30,25,25,value,20.000,\"a source\"\n"
            "\"a, \"\"b\"\"\",\"GFLOPS\",csx600,300,292,308,value,0.000,\"a source\"\n"
            "\"a, \"\"b\"\"\",\"GFLOPS\",csx600,1.5,2,2,at least,-25.000,\"a source\"\n"
            "\"a, \"\"b\"\"\",\"GFLOPS\",csx600,0.25,0.5,0.5,at most,0.000,\"a source\"\n");
  const nlohmann::ordered_json json = to_json(validation);
  EXPECT_EQ(json.at("figures").size(), 4u);
  EXPECT_DOUBLE_EQ(json.at("figures")[0].at("error_percent").get<double>(), 20);
  EXPECT_EQ(json.at("runs")[0].at("percent_of_cycles").at("stolen").get<double>(), 25);
  EXPECT_EQ(json.at("transfers")[0].at("save_bytes_per_second").get<double>(), 5e8);
  const std::string text = validation_text(validation);
  EXPECT_NE(text.find("! a, \"b\": why it is off\n"), std::string::npos) << text;
  EXPECT_EQ(text.find("never said"), std::string::npos);
  for (const char* part :
       {"+20.0%!", "292 to 308", ">= 2", "-25.0%!", "< 0.5", "poly 75.0 %", "0.600    0.500"})
    EXPECT_NE(text.find(part), std::string::npos) << part << " in\n" << text;
}

}  // namespace validation_test
