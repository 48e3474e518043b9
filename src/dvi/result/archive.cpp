#include "dvi/result/archive.h"

#include <cerrno>
#include <cstring>
#include <limits>
#include <utility>

#include "dvi/core/error.h"

namespace dvi::result {

ArchiveWriter::ArchiveWriter(const fs::path& file, const std::string& schema)
    : file_(file), draft_(file, temporary_beside(file)), out_(draft_.path(), std::ios::binary) {
  *this << schema;
}

void ArchiveWriter::pass_bytes(const void* from, std::size_t count) {
  out_.write(static_cast<const char*>(from), static_cast<std::streamsize>(count));
}

void ArchiveWriter::finish() {
  out_.close();
  if (!out_)
    throw InputError(file_, std::string("cannot be written (") + std::strerror(errno) + ")",
                     "free space or choose another folder");
  draft_.finish();
}

ArchiveReader::ArchiveReader(fs::path file, const std::string& schema) : file_(std::move(file)) {
  require_regular_file(file_, std::numeric_limits<std::uintmax_t>::max());
  left_ = fs::file_size(file_);
  in_.open(file_, std::ios::binary);
  std::string found;
  *this >> found;
  if (found != schema) refuse("does not have the schema " + schema);
}

void ArchiveReader::pass_bytes(void* to, std::size_t count) {
  if (count > left_ ||
      in_.rdbuf()->sgetn(static_cast<char*>(to), static_cast<std::streamsize>(count)) != static_cast<std::streamsize>(count))
    refuse("is truncated");
  left_ -= count;
}

std::size_t ArchiveReader::read_count() {
  std::size_t count = 0;
  *this >> count;
  if (count > left_) refuse("is truncated");
  return count;
}

void ArchiveReader::finish() const {
  if (left_ > 0) refuse("is longer than its contents");
}

void ArchiveReader::refuse(const std::string& problem) const {
  throw InputError(file_, problem, "run the command that made it again");
}

}  // namespace dvi::result
