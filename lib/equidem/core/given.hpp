// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Contents in memory that stand for files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

namespace equidem {

/// A content, such as the text of a case file, that is read in place of the file of its name while this object exists.
/// Names hold a number, so that no two are equal; any thread may read them.
template <class Content>
class Given {
 public:
  /// \param kind of content, the first part of the name
  Given(const std::string& kind, std::shared_ptr<const Content> content) {
    const std::lock_guard lock(mutex);
    name_ = kind + "#" + std::to_string(++last);
    contents.emplace(name_, std::move(content));
  }
  ~Given() {
    const std::lock_guard lock(mutex);
    contents.erase(name_);
  }
  Given(const Given&) = delete;
  Given& operator=(const Given&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }
  /// The content with this name; null where there is none.
  static std::shared_ptr<const Content> find(const std::filesystem::path& name) {
    const std::lock_guard lock(mutex);
    const auto found = contents.find(name.string());
    return found != contents.end() ? found->second : nullptr;
  }

 private:
  inline static std::mutex mutex;
  inline static std::map<std::string, std::shared_ptr<const Content>> contents;
  inline static std::uint64_t last = 0;
  std::string name_;
};

}  // namespace equidem
