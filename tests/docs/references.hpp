#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

/// Follows what sources and pages cite: sections, sources of facts, files, links.
namespace test_support {

/// What of a Markdown page can be cited.
struct Page {
  std::set<std::string> sections;  ///< "6.2": of headings "### 6.2 ..." and "### Section 6.2: ..."
  std::set<std::string> headings;  ///< as they are written, without their number
  std::set<std::string> anchors;   ///< of headings, as web hosts of repositories make them
  std::set<std::string> sources;   ///< "S5": first cells of a table whose head is "id"
  std::set<std::string> figures;   ///< "1": of "figure 1"
  std::set<std::string> items;     ///< "4": of numbered lists
};

Page parse_page(const std::string& markdown);

/// A reference that leads nowhere.
struct BrokenReference {
  std::string file;
  int line = 0;
  std::string reference;
  std::string problem;
};

struct FollowedReferences {
  int followed = 0;  ///< broken ones included
  std::vector<BrokenReference> broken;
};

/// Resolves references against a directory that holds the whole project.
class ReferenceChecker {
 public:
  explicit ReferenceChecker(std::filesystem::path root) : root_(std::move(root)) {}

  /// Sources, scripts, settings and pages below the root, as paths relative to it; neither what a build
  /// leaves nor what others wrote.
  std::vector<std::string> files() const;

  /// Of a text as if it stood in `file`, relative to the root.
  FollowedReferences follow(const std::string& file, const std::string& text) const;
  FollowedReferences follow_file(const std::string& file) const;

 private:
  class Text;

  /// Throws std::runtime_error for a page that cannot be read.
  const Page& page(const std::string& file) const;
  /// The file that `file` means by `name`: from its own directory, from the root or in docs/; "" for none.
  std::string resolve(const std::string& file, const std::string& name) const;
  /// The page that a text in `file` cites as `document`; "" for none.
  std::string cited_page(const std::string& file, const std::string& document) const;
  bool exists(const std::string& path) const;

  void follow_tags(const Text& text, FollowedReferences& result) const;
  void follow_sections(const Text& text, FollowedReferences& result) const;
  void follow_pages(const Text& text, FollowedReferences& result) const;
  void follow_paths(const Text& text, FollowedReferences& result) const;
  void follow_links(const Text& text, FollowedReferences& result) const;

  std::filesystem::path root_;
  mutable std::map<std::string, Page> pages_;
};

}  // namespace test_support
