#include "testbench/commands/output_files.hpp"

#include <algorithm>
#include <stdexcept>

#include "testbench/files/atomic_file.hpp"
#include "testbench/files/file_identity.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

[[noreturn]] void refuse_shared(const std::string& option, const std::string& path,
                                const std::string& other_option) {
  throw InputError(option + ": found '" + path + "', which " + other_option +
                   " writes too; allowed is a file of its own");
}

[[noreturn]] void refuse_input(const std::string& option, const std::string& path,
                               const std::string& named_by) {
  throw InputError(option + ": found '" + path + "', which is an input (" + named_by +
                   "); allowed is a file of its own");
}

}  // namespace

std::string error_of_no_file(const std::string& path) {
  return path.empty() ? "found '', allowed is the name of a file" : "";
}

void require_outputs_apart(const std::vector<OutputOption>& outputs, const std::vector<InputName>& inputs) {
  std::vector<std::pair<FileIdentity, std::string>> taken;
  for (const auto& [option, path] : outputs) {
    if (path.empty()) continue;
    const FileIdentity identity(path);
    for (const auto& [other, other_option] : taken)
      if (other == identity) refuse_shared(option, path, other_option);
    taken.emplace_back(identity, option);
    for (const auto& [named_by, input] : inputs)
      if (!input.empty() && FileIdentity(input) == identity) refuse_input(option, path, named_by);
  }
}

CLI::Option& OutputFiles::add_to(CLI::App& command, const std::string& names, const std::string& meaning) {
  const std::size_t begin = names.find("--");
  const std::string option = names.substr(begin, names.find(',', begin) - begin);
  files_.emplace_back(option, "");
  return *command.add_option(names, files_.back().second, meaning)
              ->check(error_of_no_file, "")
              ->type_name("FILE");
}

const std::string& OutputFiles::path(const std::string& option) const {
  for (const auto& [name, path] : files_)
    if (name == option) return path;
  throw std::logic_error("no output option " + option);
}

bool OutputFiles::any() const {
  return std::any_of(files_.begin(), files_.end(),
                     [](const OutputOption& file) { return !file.second.empty(); });
}

std::vector<OutputOption> OutputFiles::with(const std::vector<OutputOption>& others) const {
  std::vector<OutputOption> all = others;
  all.insert(all.end(), files_.begin(), files_.end());
  return all;
}

void OutputFiles::require_writable(const std::vector<OutputOption>& others) const {
  require_outputs_apart(with(others), {});
  for (const auto& [option, path] : files_)
    if (!path.empty()) testbench::require_writable(path);
}

void OutputFiles::require_no_input(const std::vector<InputName>& inputs,
                                   const std::vector<OutputOption>& others) const {
  require_outputs_apart(with(others), inputs);
}

void OutputFiles::write(const std::string& option, const std::function<std::string()>& make) const {
  if (!path(option).empty()) write_bytes_atomically(path(option), make());
}

}  // namespace testbench
