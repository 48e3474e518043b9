#include "dvi/job/choices.h"

namespace dvi::job {
namespace {

// The kind of this name; the first for an empty text, the last, which has no name, for any other.
template <class Kind>
Kind parse_kind(const std::string& text, Kind last) {
  for (const auto& [kind, name] : names_of(last))
    if (text == name || text.empty()) return kind;
  return last;
}

}  // namespace

PosesFrom PosesFrom::parse(const std::string& text) {
  const Kind kind = parse_kind(text, Kind::file);
  return {kind, kind == Kind::file ? text : ""};
}

std::string to_string(const PosesFrom& from) { return from.kind == PosesFrom::Kind::file ? from.file : to_string(from.kind); }

MasksFrom MasksFrom::parse(const std::string& text) {
  for (const labels::Polarity polarity : {labels::Polarity::white, labels::Polarity::black})
    if (const std::string prefix = to_string(polarity) + ":"; text.starts_with(prefix) && text.size() > prefix.size())
      return {Kind::path, text.substr(prefix.size()), polarity};
  const Kind kind = parse_kind(text, Kind::path);
  return {kind, kind == Kind::path ? text : ""};
}

std::string to_string(const MasksFrom& from) {
  if (from.kind != MasksFrom::Kind::path) return to_string(from.kind);
  return from.polarity == labels::Polarity::automatic ? from.path : to_string(from.polarity) + ":" + from.path;
}

std::string to_string(const std::vector<MasksFrom>& sources) {
  std::string out;
  for (const MasksFrom& from : sources) out += (out.empty() ? "" : " ") + to_string(from);
  return out;
}

}  // namespace dvi::job
