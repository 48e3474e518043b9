#include "dvi/job/choices.h"

namespace dvi::job {

PosesFrom PosesFrom::parse(const std::string& text) {
  if (text.empty() || text == "auto") return {};
  if (text == "given") return {Kind::given};
  if (text == "loam") return {Kind::loam};
  return {Kind::file, text};
}

std::string to_string(const PosesFrom& from) {
  switch (from.kind) {
    case PosesFrom::Kind::automatic:
      return "auto";
    case PosesFrom::Kind::given:
      return "given";
    case PosesFrom::Kind::loam:
      return "loam";
    case PosesFrom::Kind::file:
      break;
  }
  return from.file;
}

MasksFrom MasksFrom::parse(const std::string& text) {
  if (text.empty() || text == "auto") return {};
  if (text == "labels") return {Kind::labels};
  if (text == "found") return {Kind::found};
  return {Kind::path, text};
}

std::string to_string(const MasksFrom& from) {
  switch (from.kind) {
    case MasksFrom::Kind::automatic:
      return "auto";
    case MasksFrom::Kind::labels:
      return "labels";
    case MasksFrom::Kind::found:
      return "found";
    case MasksFrom::Kind::path:
      break;
  }
  return from.path;
}

}  // namespace dvi::job
