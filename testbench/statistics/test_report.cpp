#include "testbench/statistics/test_report.hpp"

#include <map>
#include <pugixml.hpp>
#include <sstream>

#include "testbench/system/message_text.hpp"

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;

std::string text_of(const std::optional<Json>& value) {
  return value ? value_of(*value) : "missing";
}

}  // namespace

std::string junit_xml(const std::string& suite, const std::vector<TestCase>& cases) {
  pugi::xml_document document;
  pugi::xml_node declaration = document.append_child(pugi::node_declaration);
  declaration.append_attribute("version") = "1.0";
  declaration.append_attribute("encoding") = "UTF-8";
  pugi::xml_node list = document.append_child("testsuite");
  list.append_attribute("name") = printable(suite).c_str();
  list.append_attribute("tests") = unsigned(cases.size());
  unsigned failures = 0;
  for (const TestCase& of : cases) {
    pugi::xml_node node = list.append_child("testcase");
    node.append_attribute("classname") = printable(of.group).c_str();
    node.append_attribute("name") = printable(of.name).c_str();
    if (of.failure.empty()) continue;
    ++failures;
    pugi::xml_node failure = node.append_child("failure");
    failure.append_attribute("message") = of.failure.substr(0, of.failure.find('\n')).c_str();
    failure.text() = of.failure.c_str();
  }
  list.append_attribute("failures") = failures;
  std::ostringstream xml;
  document.save(xml, "  ");
  return xml.str();
}

std::vector<TestCase> cases_of(const Comparison& comparison) {
  std::map<std::string, const Difference*> differences;
  for (const Difference& difference : comparison.differences) differences[difference.key] = &difference;
  std::vector<TestCase> cases;
  for (const std::string& key : comparison.keys) {
    const auto found = differences.find(key);
    std::string failure;
    if (found != differences.end())
      failure =
          text_of(found->second->a) + " in the first run, " + text_of(found->second->b) + " in the second";
    cases.push_back({group_of(key), name_of(key), std::move(failure)});
  }
  return cases;
}

Json differences_json(const std::vector<Difference>& differences) {
  Json list = Json::array();
  for (const Difference& of : differences) {
    const std::optional<double> relative = of.relative();
    list.push_back({{"key", of.key},
                    {"a", of.a.value_or(Json())},
                    {"b", of.b.value_or(Json())},
                    {"relative", relative ? Json(*relative) : Json()},
                    {"unit", unit_of(of.key)}});
  }
  return list;
}

}  // namespace testbench
