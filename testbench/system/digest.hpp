#pragma once

#include <memory>
#include <string>
#include <string_view>

struct evp_md_ctx_st;

namespace testbench {

/// A SHA-256 over bytes that come piece by piece. Throws RunError if OpenSSL fails.
class Sha256 {
 public:
  Sha256();

  void add(std::string_view bytes);
  /// 64 hexadecimal digits, once.
  std::string finish();

 private:
  struct Free {
    void operator()(evp_md_ctx_st* context) const;
  };
  std::unique_ptr<evp_md_ctx_st, Free> context_;
};

/// Returns the SHA-256 of `bytes` as 64 hexadecimal digits.
std::string sha256(std::string_view bytes);

}  // namespace testbench
