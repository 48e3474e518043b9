#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace dvi {

using OptionValue = std::variant<bool, std::int64_t, double, std::string, std::vector<std::string>>;

/// Smallest and largest value of a number.
struct Range {
  double low = 0, high = 0;
};

/// One field of an options struct as TOML, `--set`, `dvi config dump` and the docs see it.
struct Option {
  std::string section, key, doc;
  std::vector<std::string> choices;  ///< of a string option; empty: any string
  std::function<OptionValue()> get;
  std::function<void(const OptionValue&)> set;  ///< throws std::invalid_argument with the reason

  std::string name() const { return section + "." + key; }
  std::string text() const;  ///< its value as TOML
};

/// The one description of all options: a stage's struct describes itself into it, field by field, and everything that
/// reads, writes or documents options works from it. Holds references to the fields.
class OptionTable {
 public:
  /// Fields added from now on belong to this section.
  void section(std::string name) { section_ = std::move(name); }

  void add(std::string key, bool& field, std::string doc);
  void add(std::string key, int& field, Range range, std::string doc);
  void add(std::string key, double& field, Range range, std::string doc);
  void add(std::string key, std::string& field, std::vector<std::string> choices, std::string doc);
  void add(std::string key, std::vector<std::string>& field, std::string doc);

  const std::vector<Option>& options() const { return options_; }

  /// `section.key=value`, as `--set` takes it. UsageError with what would be right.
  void set(std::string_view assignment);
  /// Sets what the file's tables name; tables not known here are left to others if in `ignore`. UsageError otherwise.
  void load_toml(const std::filesystem::path& path, const std::vector<std::string>& ignore = {});
  /// Every option with its doc line as TOML that load_toml reads back.
  std::string dump_toml() const;

 private:
  const Option& find(const std::string& name) const;

  std::string section_;
  std::vector<Option> options_;
};

}  // namespace dvi
