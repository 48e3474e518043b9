#include "dvi/bags/changed_copy.h"

#include <algorithm>
#include <string>

#include "dvi/core/error.h"
#include "dvi/core/interrupt.h"

namespace dvi::bags {
namespace {

constexpr std::uint64_t kPieceBytes = std::uint64_t{4} << 20;

[[noreturn]] void fail_to_write(const fs::path& file) {
  throw InputError(file, "cannot be written", "free space or choose another folder");
}

}  // namespace

ChangedCopy::ChangedCopy(const BagFile& from, fs::path to) : from_(from), to_(std::move(to)), out_(to_, std::ios::binary) {
  if (!out_) fail_to_write(to_);
}

void ChangedCopy::write(std::string_view bytes) {
  if (!out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()))) fail_to_write(to_);
  size_ += bytes.size();
}

void ChangedCopy::keep(std::uint64_t at, std::uint64_t count) {
  while (count > 0) {
    throw_if_interrupted();
    const std::string piece = from_.read(at, std::min(count, kPieceBytes));
    if (watch) watch(piece, piece);
    write(piece);
    at += piece.size(), count -= piece.size();
  }
}

void ChangedCopy::replace(std::string_view original, std::string_view bytes) {
  if (watch) watch(original, bytes);
  write(bytes);
}

void ChangedCopy::overwrite(std::uint64_t at, std::string_view bytes) {
  const auto end = out_.tellp();
  out_.seekp(static_cast<std::streamoff>(at));
  out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!out_.seekp(end)) fail_to_write(to_);
}

void ChangedCopy::finish() {
  out_.close();
  if (!out_) fail_to_write(to_);
}

}  // namespace dvi::bags
