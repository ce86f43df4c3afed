#include "testbench/commands/output_files.hpp"

#include <filesystem>
#include <map>
#include <stdexcept>

#include "testbench/system/atomic_file.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

[[noreturn]] void refuse_shared(const std::string& option, const std::string& path,
                                const std::string& other_option) {
  throw InputError(option + ": found '" + path + "', which " + other_option +
                   " writes too; allowed is a file of its own");
}

}  // namespace

CLI::Option& OutputFiles::add_to(CLI::App& command, const std::string& names, const std::string& meaning) {
  const std::size_t begin = names.find("--");
  const std::string option = names.substr(begin, names.find(',', begin) - begin);
  files_.emplace_back(option, "");
  return *command.add_option(names, files_.back().second, meaning)->type_name("FILE");
}

const std::string& OutputFiles::path(const std::string& option) const {
  for (const auto& [name, path] : files_)
    if (name == option) return path;
  throw std::logic_error("no output option " + option);
}

void OutputFiles::require_writable(const std::vector<OutputOption>& others) const {
  std::vector<OutputOption> all = others;
  all.insert(all.end(), files_.begin(), files_.end());
  std::map<std::filesystem::path, std::string> option_of;
  for (const auto& [option, path] : all) {
    if (path.empty()) continue;
    const auto [other, is_first] =
        option_of.emplace(std::filesystem::absolute(path).lexically_normal(), option);
    if (!is_first) refuse_shared(option, path, other->second);
  }
  for (const auto& [option, path] : files_)
    if (!path.empty()) testbench::require_writable(path);
}

void OutputFiles::write(const std::string& option, const std::function<std::string()>& make) const {
  if (!path(option).empty()) write_bytes_atomically(path(option), make());
}

}  // namespace testbench
