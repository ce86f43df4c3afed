// One table declares the firmware's options: what it says must hold for ProgramConfig.

#include "firmware/path_tracer/program/program_options.hpp"

#include <gtest/gtest.h>

#include <set>

namespace program_options_test {

using path_tracer::OptionGroup;
using path_tracer::OptionValue;
using path_tracer::ProgramConfig;
using path_tracer::ProgramOption;

/// Texts that an option allows: the ends of a range, every name.
std::vector<std::string> allowed_texts(const ProgramOption& option) {
  if (const auto* const range = std::get_if<path_tracer::IntegerRange>(&option.allowed))
    return {std::to_string(range->low), std::to_string(range->high)};
  if (const auto* const list = std::get_if<path_tracer::IntegerList>(&option.allowed)) {
    std::vector<std::string> texts;
    for (const std::int64_t value : *list) texts.push_back(std::to_string(value));
    return texts;
  }
  if (const auto* const names = std::get_if<path_tracer::Names>(&option.allowed)) return *names;
  if (std::holds_alternative<path_tracer::Unsigned64>(option.allowed)) return {"0", "18446744073709551615"};
  return {"0.001", "0.999"};
}

/// Every option's value, so that a change of any of them shows.
std::vector<std::string> values(const ProgramConfig& config) {
  std::vector<std::string> texts;
  for (const ProgramOption& option : path_tracer::program_options())
    texts.push_back(path_tracer::value_text(option.read(config)));
  return texts;
}

TEST(ProgramOptions, HaveNamesUnitsMeaningsAndGroupsInOneStretch) {
  std::set<std::string> names;
  std::set<OptionGroup> groups;
  const ProgramOption* last = nullptr;
  for (const ProgramOption& option : path_tracer::program_options()) {
    EXPECT_TRUE(names.insert(option.name).second) << option.name << " twice";
    EXPECT_EQ(option.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz_"), std::string::npos);
    EXPECT_FALSE(option.unit.empty()) << option.name;
    EXPECT_GT(option.meaning.size(), 8u) << option.name;
    if (last == nullptr || last->group != option.group) {
      EXPECT_TRUE(groups.insert(option.group).second) << option.name;
    }
    EXPECT_EQ(path_tracer::find_option(option.name), &option);
    last = &option;
  }
  EXPECT_EQ(groups.size(), path_tracer::kOptionGroupNames.size());
  EXPECT_EQ(path_tracer::find_option("depth"), nullptr);
}

TEST(ProgramOptions, EachWritesItsOwnFieldAndReadsItBack) {
  for (const ProgramOption& option : path_tracer::program_options())
    for (const std::string& text : allowed_texts(option)) {
      ProgramConfig config = path_tracer::default_program();
      const std::optional<OptionValue> value = path_tracer::value_of(option, text);
      ASSERT_TRUE(value) << option.name << " " << text;
      option.write(config, *value);
      EXPECT_EQ(option_text(config, option.name), text) << option.name;
      option.write(config, option.default_value);
      EXPECT_EQ(values(config), values(path_tracer::default_program())) << option.name << " left a trace";
    }
}

TEST(ProgramOptions, WhatIsNotAllowedIsNoValue) {
  const auto is_value = [](const char* name, const char* text) {
    return path_tracer::value_of(*path_tracer::find_option(name), text).has_value();
  };
  for (const char* text : {"", "-1", "9", "1.5", "1x", " 1", "one"})
    EXPECT_FALSE(is_value("n", text)) << text;
  for (const char* text : {"", "6", "0", "4100"}) EXPECT_FALSE(is_value("slot_vertices", text)) << text;
  for (const char* text : {"3", "-1", "64"}) EXPECT_FALSE(is_value("stack_entries", text)) << text;
  for (const char* text : {"0", "1", "-0.5", "nan", "2", ""})
    EXPECT_FALSE(is_value("max_survival", text)) << text;
  for (const char* text : {"-1", "18446744073709551616", "1.0"}) EXPECT_FALSE(is_value("seed", text)) << text;
  for (const char* text : {"", "Full", "fulls", "0", "segments direct"})
    EXPECT_FALSE(is_value("program", text)) << text;
  EXPECT_EQ(allowed_text(*path_tracer::find_option("slot_vertices")),
            "an integer from 4 to 4096, a multiple of 4");
  EXPECT_EQ(allowed_text(*path_tracer::find_option("max_survival")), "a number above 0 and below 1");
  EXPECT_EQ(allowed_text(*path_tracer::find_option("buffer")), "one of none, loads, saves, both");
}

/// The table's defaults are those of a plain ProgramConfig, but for the sampling, which is the best one.
TEST(ProgramOptions, DefaultsAreThoseOfTheMembersButForTheSampling) {
  const ProgramConfig plain;
  const ProgramConfig best = path_tracer::default_program();
  EXPECT_NO_THROW(path_tracer::validate(best));
  for (const ProgramOption& option : path_tracer::program_options()) {
    EXPECT_TRUE(is_allowed(option, option.default_value)) << option.name;
    EXPECT_EQ(path_tracer::value_text(option.read(best)), path_tracer::value_text(option.default_value))
        << option.name;
    if (option.group != OptionGroup::sampling) {
      EXPECT_EQ(path_tracer::value_text(option.read(plain)), path_tracer::value_text(option.default_value))
          << option.name;
    }
  }
  EXPECT_EQ(best.sampler, path_tracer::Sampler::sobol);
  EXPECT_EQ(best.light_sampling, path_tracer::LightSampling::solid_angle);
  EXPECT_EQ(best.roulette_start, 3);
  EXPECT_EQ(best.max_survival, plain.max_survival);
  EXPECT_EQ(best.seed, plain.seed);
}

/// An option that is out of its range is refused, whoever set it.
TEST(ProgramOptions, ValidationReadsTheTable) {
  for (const ProgramOption& option : path_tracer::program_options()) {
    const auto* const range = std::get_if<path_tracer::IntegerRange>(&option.allowed);
    if (range == nullptr) continue;
    ProgramConfig config = path_tracer::default_program();
    config.traversal = path_tracer::Traversal::refill;
    option.write(config, OptionValue(range->high + range->multiple_of));
    try {
      path_tracer::validate(config);
      ADD_FAILURE() << option.name;
    } catch (const path_tracer::ProgramError& error) {
      EXPECT_EQ(error.what(), option.name + ": found " + path_tracer::value_text(option.read(config)) +
                                  ", allowed is " + allowed_text(option));
    }
  }
}

}  // namespace program_options_test
