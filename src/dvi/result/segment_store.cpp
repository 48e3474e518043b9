#include "dvi/result/segment_store.h"

#include <utility>

#include "dvi/core/error.h"
#include "dvi/core/hash.h"
#include "dvi/result/archive.h"
#include "dvi/result/manifest.h"
#include "dvi/result/result_layout.h"

namespace dvi::result {

constexpr auto fields_of(Of<media::EncodedFrame>) {
  return std::tuple{&media::EncodedFrame::is_key, &media::EncodedFrame::bytes};
}
constexpr auto fields_of(Of<MediaSegment>) { return std::tuple{&MediaSegment::result, &MediaSegment::compare}; }

namespace {

using Names = std::span<const std::string>;

const char* const kVideoFolder = ".dvi/video";
const char* const kSegmentSchema = "dvi-video-segment/1";

std::string file_of(Names names) { return std::string(kVideoFolder) + "/" + names.front() + ".bin"; }
fs::path manifest_of(const fs::path& out, Names names) { return out / kVideoFolder / (names.front() + ".json"); }

/// Returns the hash of the inputs, the options, and the images of finished frames; none if a frame is not finished.
std::optional<std::string> compute_fingerprint(const fs::path& out, Names names) {
  std::string all;
  for (const std::string& name : names) {
    const std::optional<Manifest> manifest = read_manifest(frame_manifest(out, name));
    if (!manifest || !manifest->content) return std::nullopt;
    all += name + " " + manifest->fingerprint;
    for (const ListedFile& listed : manifest->files) all += " " + listed.file + " " + listed.hash;
    all += "\n";
  }
  return compute_hash(all);
}

}  // namespace

SegmentStore::SegmentStore(fs::path out) : out_(std::move(out)) {}

bool SegmentStore::lacks(Names names) const {
  const std::optional<std::string> fingerprint = compute_fingerprint(out_, names);
  return fingerprint && !is_confirmed(manifest_of(out_, names), *fingerprint, out_);
}

std::optional<MediaSegment> SegmentStore::read(Names names) const {
  if (!fs::exists(manifest_of(out_, names))) return std::nullopt;
  const std::optional<std::string> fingerprint = compute_fingerprint(out_, names);
  if (!fingerprint || !is_confirmed(manifest_of(out_, names), *fingerprint, out_)) return std::nullopt;
  ArchiveReader in(out_ / file_of(names), kSegmentSchema);
  MediaSegment segment;
  in >> segment;
  in.finish();
  return segment;
}

void SegmentStore::write(Names names, const MediaSegment& segment) const {
  const std::optional<std::string> fingerprint = compute_fingerprint(out_, names);
  if (!fingerprint)
    throw InputError(frame_manifest(out_, names.front()), "was changed by another program during the run", "run again");
  make_folder(manifest_of(out_, names).parent_path());
  ArchiveWriter out(out_ / file_of(names), kSegmentSchema);
  out << segment;
  out.finish();
  write_manifest(manifest_of(out_, names), {*fingerprint, list_contents(out_, {file_of(names)})});
}

void SegmentStore::remove_all() const {
  if (fs::is_directory(fs::symlink_status(out_ / kVideoFolder))) fs::remove_all(out_ / kVideoFolder);
}

}  // namespace dvi::result
