#include "testbench/commands/usage_error.hpp"

#include <algorithm>
#include <cctype>

#include "testbench/system/message_text.hpp"
#include "testbench/system/nearest_name.hpp"

namespace testbench {
namespace {

std::string did_you_mean(const std::string& word, const std::vector<std::string>& names) {
  const std::string nearest = nearest_name(word, names);
  if (!nearest.empty()) return "did you mean '" + nearest + "'?";
  constexpr std::size_t kMostListed = 24;
  if (names.size() <= kMostListed) return "allowed is one of " + CLI::detail::join(names, ", ");
  const std::vector<std::string> first(names.begin(), names.begin() + kMostListed);
  return "allowed is one of " + CLI::detail::join(first, ", ") + " and " +
         std::to_string(names.size() - kMostListed) + " more";
}

std::vector<std::string> names_of_commands(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* const command : app.get_subcommands(nullptr)) names.push_back(command->get_name());
  return names;
}

std::vector<std::string> names_of_options(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* const option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

bool is_option(const std::string& word) {
  return word.size() > 1 && word[0] == '-' && std::isdigit(static_cast<unsigned char>(word[1])) == 0;
}

/// "--size" of "--size=8x6".
std::string option_of(const std::string& word) {
  return word.substr(0, word.find('='));
}

/// The first word that names no command or option where it should; "" if each does.
std::string unknown_name(const CLI::App& program, const std::vector<std::string>& words) {
  const CLI::App* app = &program;
  for (const std::string& word : words) {
    const std::vector<std::string> commands = names_of_commands(*app);
    if (is_option(word)) {
      const std::string option = option_of(word);
      if (app->get_option_no_throw(option) == nullptr)
        return option + ": unknown option; " + did_you_mean(option, names_of_options(*app));
    } else if (std::find(commands.begin(), commands.end(), word) != commands.end()) {
      app = app->get_subcommand(word);
    } else if (!commands.empty()) {
      return shortened(word) + ": unknown command; " + did_you_mean(word, commands);
    }
  }
  return "";
}

}  // namespace

std::string usage_error_text(const CLI::App& program, const CLI::Error& error,
                             const std::vector<std::string>& words) {
  const bool is_unexpected = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr ||
                             dynamic_cast<const CLI::RequiredError*>(&error) != nullptr;
  const std::string unknown = is_unexpected ? unknown_name(program, words) : "";
  return (unknown.empty() ? error.what() : unknown) + std::string(" (see csx600 --help)");
}

}  // namespace testbench
