#include "tests/docs/references.hpp"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <regex>
#include <sstream>
#include <stdexcept>

namespace test_support {
namespace {

namespace fs = std::filesystem;

const std::string kReferencePage = "docs/csx600.md";
const std::string kPaperPage = "docs/paper.md";

bool ends_with(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

bool is_markdown(const std::string& file) {
  return ends_with(file, ".md");
}

std::string read_text(const fs::path& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path.string());
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// Lower case, words joined by hyphens, other marks left out.
std::string anchor_of(const std::string& heading) {
  std::string anchor;
  for (const char c : heading) {
    if (c == ' ' || c == '-') {
      anchor += '-';
    } else if (c == '_' || std::isalnum(static_cast<unsigned char>(c)) != 0) {
      anchor += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
  }
  return anchor;
}

/// The word before an offset: "paper" of "the paper's (section", "csx600.md" of "[facts](csx600.md),
/// section".
std::string document_before(const std::string& text, std::size_t offset) {
  static const std::regex last_word(R"re(([A-Za-z0-9_./-]+)(?:'s|[,;:)"])*\s*\(?$)re");
  constexpr std::size_t kLongest = 160;
  const std::string before = text.substr(offset - std::min(offset, kLongest), std::min(offset, kLongest));
  std::smatch match;
  return std::regex_search(before, match, last_word) ? match[1].str() : "";
}

std::vector<std::smatch> matches(const std::string& text, const std::regex& pattern) {
  return {std::sregex_iterator(text.begin(), text.end(), pattern), std::sregex_iterator()};
}

}  // namespace

Page parse_page(const std::string& markdown) {
  static const std::regex heading(R"(#+ +(?:(?:Section )?(\d+(?:\.\d+)*)[.:]? +)?(.*))");
  static const std::regex source(R"(\| *([^|]*[^| ]) *\|.*)");
  static const std::regex figure(R"([Ff]igure (\d+))");
  static const std::regex item(R"((\d+)\. .*)");
  Page page;
  bool in_sources = false;
  std::istringstream lines(markdown);
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    for (const std::smatch& found : matches(line, figure)) page.figures.insert(found[1]);
    if (std::regex_match(line, match, heading)) {
      if (match[1].matched) page.sections.insert(match[1]);
      page.headings.insert(match[2]);
      page.anchors.insert(anchor_of(line.substr(line.find_first_not_of("# "))));
    } else if (std::regex_match(line, match, source)) {
      if (in_sources) page.sources.insert(match[1]);
      if (match[1] == "id") in_sources = true;
    } else {
      in_sources = false;
      if (std::regex_match(line, match, item)) page.items.insert(match[1]);
    }
  }
  return page;
}

/// A text with its line breaks, and the marks of comments and of adjoining string literals around them,
/// turned into spaces, so that a citation may go over two lines.
class ReferenceChecker::Text {
 public:
  Text(std::string file, const std::string& text) : file_(std::move(file)) {
    std::istringstream lines(text);
    int number = 0;
    bool fenced = false;
    for (std::string line; std::getline(lines, line);) {
      ++number;
      if (line.rfind("```", 0) == 0) fenced = !fenced;
      starts_.emplace_back(joined_.size(), number);
      joined_ += unmarked(line) + ' ';
      const bool is_code = fenced || line.rfind("    ", 0) == 0;
      prose_starts_.emplace_back(prose_.size(), number);
      prose_ += (is_code ? "" : without_code(line)) + '\n';
    }
    join_literals();
  }

  const std::string& file() const { return file_; }
  const std::string& joined() const { return joined_; }
  /// Markdown without its code, line by line.
  const std::string& prose() const { return prose_; }

  int line_of(std::size_t offset) const { return line_at(starts_, offset); }
  int prose_line_of(std::size_t offset) const { return line_at(prose_starts_, offset); }

 private:
  using Starts = std::vector<std::pair<std::size_t, int>>;

  static int line_at(const Starts& starts, std::size_t offset) {
    const auto after = std::upper_bound(starts.begin(), starts.end(), std::make_pair(offset, 1 << 30));
    return after == starts.begin() ? 1 : std::prev(after)->second;
  }

  /// As long as the line, or offsets would no longer tell lines: marks become spaces.
  std::string unmarked(std::string line) const {
    static const std::regex mark(R"(^\s*(///?<?|#|\*)?)");
    if (is_markdown(file_)) return line;
    std::smatch match;
    if (std::regex_search(line, match, mark)) std::fill(line.begin(), line.begin() + match.length(), ' ');
    return line;
  }

  /// Quotes between which there are only spaces become spaces.
  void join_literals() {
    for (std::size_t quote = joined_.find('"'); quote != std::string::npos;) {
      const std::size_t next = joined_.find_first_not_of(' ', quote + 1);
      if (next == std::string::npos) return;
      if (joined_[next] == '"' && next > quote + 1) joined_[quote] = joined_[next] = ' ';
      quote = joined_.find('"', quote + 1);
    }
  }

  static std::string without_code(const std::string& line) {
    static const std::regex code("`[^`]*`");
    return std::regex_replace(line, code, "``");
  }

  std::string file_;
  std::string joined_;
  std::string prose_;
  Starts starts_;
  Starts prose_starts_;
};

std::vector<std::string> ReferenceChecker::files() const {
  static const std::set<std::string> left_out = {"build", "out", ".git", "testbench/report/echarts",
                                                 "tests/docs"};  // which breaks references on purpose
  static const std::set<std::string> kinds = {".cpp", ".hpp", ".md", ".txt", ".toml", ".sh", ".mtl", ".obj"};
  std::vector<std::string> files;
  for (auto entry = fs::recursive_directory_iterator(root_); entry != fs::recursive_directory_iterator();
       ++entry) {
    const std::string path = entry->path().lexically_relative(root_).generic_string();
    if (entry->is_directory()) {
      if (left_out.count(path) != 0 || ends_with(path, ".sweep")) entry.disable_recursion_pending();
    } else if (kinds.count(entry->path().extension().string()) != 0) {
      files.push_back(path);
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

bool ReferenceChecker::exists(const std::string& path) const {
  return fs::exists(root_ / path);
}

const Page& ReferenceChecker::page(const std::string& file) const {
  const auto known = pages_.find(file);
  if (known != pages_.end()) return known->second;
  return pages_.emplace(file, parse_page(read_text(root_ / file))).first->second;
}

std::string ReferenceChecker::resolve(const std::string& file, const std::string& name) const {
  for (const fs::path& from : {fs::path(file).parent_path(), fs::path(), fs::path("docs")}) {
    const std::string path = (from / name).lexically_normal().generic_string();
    if (exists(path)) return path;
  }
  return "";
}

FollowedReferences ReferenceChecker::follow_file(const std::string& file) const {
  return follow(file, read_text(root_ / file));
}

FollowedReferences ReferenceChecker::follow(const std::string& file, const std::string& text) const {
  const Text cited(file, text);
  FollowedReferences result;
  follow_tags(cited, result);
  follow_sections(cited, result);
  follow_pages(cited, result);
  follow_paths(cited, result);
  if (is_markdown(file)) follow_links(cited, result);
  return result;
}

/// "[S5, S7]": sources of facts about the chip. Where the chip is configured, "[Horowitz]", too.
void ReferenceChecker::follow_tags(const Text& text, FollowedReferences& result) const {
  static const std::regex numbered(R"(\[(S\d+[a-z]?(?:, S\d+[a-z]?)*)\])");
  static const std::regex named(R"([ ("]\[(S\d+[a-z]?(?:, S\d+[a-z]?)*|[A-Z][A-Za-z0-9]{3,}(?:-\d+)?)\])");
  for (const std::smatch& match :
       matches(text.joined(), text.file().rfind("model/config/", 0) == 0 ? named : numbered)) {
    std::istringstream ids(match[1]);
    for (std::string id; std::getline(ids >> std::ws, id, ',');) {
      ++result.followed;
      if (page(kReferencePage).sources.count(id) == 0) {
        result.broken.push_back({text.file(), text.line_of(std::size_t(match.position(1))), "[" + id + "]",
                                 "not among the sources of " + kReferencePage});
      }
    }
  }
}

/// "paper, section 3.3", "paper's section 5", "paper, figure 1", "[reference, section 6.2]", "csx600.md,
/// section 2". Without a document a page means itself; a source may not leave it out. Publications and
/// standards are not followed.
void ReferenceChecker::follow_sections(const Text& text, FollowedReferences& result) const {
  static const std::regex citation(
      R"(\b(section|figure|invariant)s? +(\d+(?:\.\d+)*(?:(?:, +| and +|, and +)\d+(?:\.\d+)*)*)(?![0-9]))",
      std::regex::icase);
  static const std::regex publication(R"((19|20)\d\d|\d+\.\d+|\d{4}(-\d{4})?)");
  static const std::regex number(R"(\d+(?:\.\d+)*)");
  for (const std::smatch& match : matches(text.joined(), citation)) {
    const std::string document = document_before(text.joined(), std::size_t(match.position()));
    if (std::regex_match(document, publication)) continue;
    const std::string file = cited_page(text.file(), document);
    const char kind = static_cast<char>(std::tolower(static_cast<unsigned char>(match.str()[0])));
    const std::string numbers = match[2];
    for (const std::smatch& cited : matches(numbers, number)) {
      ++result.followed;
      BrokenReference broken{text.file(), text.line_of(std::size_t(match.position())),
                             document + ", " + match[1].str() + " " + cited.str(),
                             "no document of that name"};
      if (file.empty()) {
        result.broken.push_back(broken);
        continue;
      }
      const Page& in = page(file);
      const std::set<std::string>& has = kind == 'f' ? in.figures : kind == 'i' ? in.items : in.sections;
      if (has.count(cited.str()) != 0) continue;
      broken.problem = file + " has no such " + match[1].str();
      result.broken.push_back(broken);
    }
  }
}

std::string ReferenceChecker::cited_page(const std::string& file, const std::string& document) const {
  if (document == "paper" || document == "Paper") return kPaperPage;
  if (document == "reference") return kReferencePage;
  if (is_markdown(document)) return resolve(file, document);
  return is_markdown(file) ? file : "";
}

/// "docs/paper.md", and in it "Known slips": pages that a text names, and headings of theirs.
void ReferenceChecker::follow_pages(const Text& text, FollowedReferences& result) const {
  static const std::regex name(
      R"re(([A-Za-z0-9_./-]*[A-Za-z0-9_-]\.md|README)\b(?!\.)(?:\]\([^)]*\))?(?:\)?, \\?"([^"\\]*)\\?")?)re");
  for (const std::smatch& match : matches(text.joined(), name)) {
    std::string written = match[1] == "README" ? "README.md" : match[1].str();
    if (written[0] == '/') written.erase(0, 1);  // behind the name of the project's directory
    ++result.followed;
    const int line = text.line_of(std::size_t(match.position(1)));
    // Outside Markdown the project's README is meant where a heading is named.
    const std::string file =
        match[1] == "README" && match[2].matched ? "README.md" : resolve(text.file(), written);
    if (file.empty()) {
      result.broken.push_back({text.file(), line, written, "no such page"});
    } else if (match[2].matched && page(file).headings.count(match[2]) == 0) {
      result.broken.push_back(
          {text.file(), line, written + ", \"" + match[2].str() + "\"", "no such heading"});
    }
  }
}

/// "tests/renders/furnace_test.cpp": files and folders of the project, from its root. Names with wildcards
/// are not followed.
void ReferenceChecker::follow_paths(const Text& text, FollowedReferences& result) const {
  if (ends_with(text.file(), "CMakeLists.txt")) return;  // CMake follows its own
  static const std::regex path(
      R"((^|[ `"'(<=])((?:firmware|model|testbench|tests|scenes|sweeps|waves|docs|\.ci)/[A-Za-z0-9_./-]*)([*<{]?))");
  for (const std::smatch& match : matches(text.joined(), path)) {
    std::string name = match[2];
    if (match[3].length() != 0 || ends_with(name, "...")) continue;
    while (name.back() == '.' || name.back() == '-') name.pop_back();
    if (is_markdown(name)) continue;  // follow_pages
    ++result.followed;
    if (!exists(name) && !exists(name + ".in")) {  // which CMake makes it from
      result.broken.push_back(
          {text.file(), text.line_of(std::size_t(match.position(2))), name, "no such file or folder"});
    }
  }
}

/// "[text](page.md#heading)"; what is on the web is not followed.
void ReferenceChecker::follow_links(const Text& text, FollowedReferences& result) const {
  static const std::regex link(R"(\]\(([^)\s]*)\))");
  for (const std::smatch& match : matches(text.prose(), link)) {
    const std::string target = match[1];
    if (target.find("://") != std::string::npos) continue;
    ++result.followed;
    const int line = text.prose_line_of(std::size_t(match.position(1)));
    const std::string name = target.substr(0, target.find('#'));
    const std::string file =
        name.empty() ? text.file()
                     : (fs::path(text.file()).parent_path() / name).lexically_normal().generic_string();
    if (target.empty() || !exists(file)) {
      result.broken.push_back({text.file(), line, target, "no such file"});
    } else if (name.size() < target.size() && page(file).anchors.count(target.substr(name.size() + 1)) == 0) {
      result.broken.push_back({text.file(), line, target, "no such heading"});
    }
  }
}

}  // namespace test_support
