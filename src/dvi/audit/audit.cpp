#include "dvi/audit/audit.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <optional>
#include <set>

#include "dvi/core/error.h"
#include "dvi/core/frame_name.h"
#include "dvi/core/threads.h"
#include "dvi/drive/warp.h"
#include "dvi/harmonize/filled_frame.h"
#include "dvi/harmonize/provenance.h"
#include "dvi/media/image_file.h"
#include "dvi/media/write_image.h"

namespace dvi::audit {
namespace {

/// The histogram of |harmonization|, summed over the channels (thirds of a gray level), for percentiles with constant memory.
using Changes = std::vector<std::size_t>;
constexpr std::size_t kMaxChange = 3 * 255;

struct FrameAudit {
  Audit audit;
  Changes changes = Changes(kMaxChange + 1, 0);
};

/// The images of one frame of a result.
struct WrittenFrame {
  WrittenFrame(const fs::path& out, const std::string& name, cv::Size size)
      : frame(media::read_image(out / picture_file("frames", name), size)),
        mask(media::read_mask(out / picture_file("masks", name), size)),
        kind(media::read_png_gray(out / picture_file("kind", name), size)),
        provenance(media::read_png_triples(out / picture_file("provenance", name), size)),
        used(media::read_image(out / picture_file("sources_used", name), size)),
        harmonization(media::read_png_triples(out / picture_file("harmonization", name), size)) {}

  harmonize::Provenance get_provenance(cv::Point p) const { return harmonize::Provenance::decode(provenance(p), used(p)); }

  cv::Mat3b frame;
  cv::Mat1b mask, kind;
  cv::Mat_<cv::Vec3w> provenance;
  cv::Mat3b used;
  cv::Mat_<cv::Vec3w> harmonization;
};

/// The images of a frame that an import changed, as the run wrote them.
struct FrameBefore {
  FrameBefore(const fs::path& folder, const std::string& name, cv::Size size)
      : frame(media::read_image(folder / picture_file("frames", name), size)),
        kind(media::read_png_gray(folder / picture_file("kind", name), size)) {}

  cv::Mat3b frame;
  cv::Mat1b kind;
};

class FrameAuditor {
 public:
  FrameAuditor(const AuditedResult& result, const Views& views, std::size_t target)
      : views_(views),
        target_(target),
        name_(result.names[target]),
        written_(result.out, name_, {views[target].camera.width, views[target].camera.height}),
        image_(views.images[target]),
        mask_(views.masks[target]) {
    if (result.imported.names.contains(name_)) before_.emplace(result.imported.before, name_, mask_->size());
  }

  FrameAudit check() {
    result_.audit.frames = 1;
    std::map<int, std::vector<cv::Point>> of_view;
    for (int y = 0; y < mask_->rows; ++y)
      for (int x = 0; x < mask_->cols; ++x) {
        const cv::Point p(x, y);
        if (((*mask_)(p) != 0) != (written_.mask(p) != 0)) add_finding(Breach::mask, p);
        result_.audit.removed += written_.mask(p) != 0 ? 1 : 0;
        if (written_.mask(p) == 0 && written_.frame(p) != (*image_)(p)) add_finding(Breach::outside, p);
        if (!is_as_run_wrote(p)) add_finding(Breach::imported, p);
        result_.audit.imported += is_imported(p) ? 1 : 0;
        if (!is_consistent(p))
          add_finding(Breach::provenance, p);
        else if (written_.provenance(p)[0] > 0)
          of_view[written_.get_provenance(p).view].push_back(p);
      }
    require_same_image();
    for (const auto& [view, pixels] : of_view) check_copies(static_cast<std::size_t>(view), pixels);
    return std::move(result_);
  }

 private:
  /// Throws InputError if most pixels outside the mask differ, as in the image of another drive.
  void require_same_image() const {
    const std::size_t kept = mask_->total() - result_.audit.removed;
    if (2 * result_.audit.findings[static_cast<std::size_t>(Breach::outside)].pixels > kept)
      throw InputError(
          "frame " + name_ +
          " of the result differs from the image of the drive: audit a result with the drives from which it was made");
  }

  bool is_imported(cv::Point p) const { return written_.kind(p) == static_cast<uchar>(harmonize::Kind::imported); }

  /// Returns whether an import replaced only an unobserved pixel, and recorded that.
  bool is_as_run_wrote(cv::Point p) const {
    if (!before_) return !is_imported(p);
    if (is_imported(p)) return harmonize::is_unobserved(before_->kind(p));
    return written_.kind(p) == before_->kind(p) && written_.frame(p) == before_->frame(p);
  }

  /// Returns whether kind, mask, and provenance agree, and the source exists.
  bool is_consistent(cv::Point p) const {
    const auto kind = static_cast<harmonize::Kind>(written_.kind(p));
    const bool copied = kind == harmonize::Kind::copied || kind == harmonize::Kind::copied_elsewhere;
    if (kind > harmonize::Kind::imported || (kind == harmonize::Kind::original) != (written_.mask(p) == 0)) return false;
    const cv::Vec3b& used = written_.used(p);
    if (copied != (written_.provenance(p)[0] > 0) || copied != (used[0] > 0 && used[1] > 0 && used[2] > 0)) return false;
    if (!copied) return true;
    const harmonize::Provenance from = written_.get_provenance(p);
    if (static_cast<std::size_t>(from.view) >= views_.size() || static_cast<std::size_t>(from.view) == target_) return false;
    const View& source = views_[static_cast<std::size_t>(from.view)];
    return source.camera.contains({from.position.x, from.position.y}) && shares_colors(source, views_[target_]) &&
           (source.sequence == views_[target_].sequence) == (kind == harmonize::Kind::copied);
  }

  void check_copies(std::size_t view, const std::vector<cv::Point>& pixels) {
    const auto image = views_.images[view];
    const auto mask = views_.masks[view];
    result_.audit.copied += pixels.size();
    for (const cv::Point p : pixels) {
      const harmonize::Provenance from = written_.get_provenance(p);
      if (!can_sample(*mask, from.position, from.footprint)) add_finding(Breach::masked_source, p);
      const cv::Vec3i copy = harmonize::copy_color(views_, target_, *image, from);
      std::size_t size = 0;
      bool same = true;
      for (int c = 0; c < 3; ++c) {
        const int change = static_cast<int>(written_.harmonization(p)[2 - c]) - harmonize::kNoChange;
        same &= copy[c] + change == static_cast<int>(written_.frame(p)[c]);
        size += static_cast<std::size_t>(std::abs(change));
      }
      if (!same) add_finding(Breach::color, p);
      ++result_.changes[std::min(size, kMaxChange)];
    }
  }

  void add_finding(Breach breach, cv::Point p) {
    Finding& finding = result_.audit.findings[static_cast<std::size_t>(breach)];
    if (finding.pixels++ == 0) {
      finding.frame = name_;
      finding.x = p.x;
      finding.y = p.y;
    }
  }

  const Views& views_;
  std::size_t target_;
  std::string name_;
  WrittenFrame written_;
  std::optional<FrameBefore> before_;  ///< none if the fill was not imported
  std::shared_ptr<const cv::Mat3b> image_;
  std::shared_ptr<const cv::Mat1b> mask_;
  FrameAudit result_;
};

void add(const FrameAudit& frame, FrameAudit& sum) {
  sum.audit.frames += frame.audit.frames;
  sum.audit.removed += frame.audit.removed;
  sum.audit.copied += frame.audit.copied;
  sum.audit.imported += frame.audit.imported;
  for (std::size_t b = 0; b < kBreaches.size(); ++b) {
    const Finding& more = frame.audit.findings[b];
    Finding& finding = sum.audit.findings[b];
    const std::size_t before = finding.pixels;
    if (before == 0) finding = more;
    finding.pixels = before + more.pixels;
  }
  for (std::size_t i = 0; i < sum.changes.size(); ++i) sum.changes[i] += frame.changes[i];
}

double compute_percentile(const Changes& changes, std::size_t count, double share) {
  std::size_t below = 0, i = 0;
  while (i < kMaxChange && static_cast<double>(below += changes[i]) < share * static_cast<double>(count)) ++i;
  return count > 0 ? static_cast<double>(i) / 3 : 0;
}

void require_known_frames(const AuditedResult& result) {
  const std::set<std::string> known(result.names.begin(), result.names.end());
  for (const std::string& frame : list_frames(result.out))
    if (!known.contains(frame))
      throw InputError(result.out / picture_file("frames", frame), "is not a frame of the drive",
                       "audit a result with the drives from which it was made");
}

}  // namespace

bool Audit::passed() const {
  return std::all_of(findings.begin(), findings.end(), [](const Finding& f) { return f.pixels == 0; });
}

Audit audit_result(const AuditedResult& result, const Views& views, const Tick& tick) {
  require_known_frames(result);
  FrameAudit sum;
  make_and_use(
      result.names.size(), [&](std::size_t i) { return FrameAuditor(result, views, i).check(); },
      [&](std::size_t, const FrameAudit& frame) {
        add(frame, sum);
        tick();
      });
  sum.audit.change_median = compute_percentile(sum.changes, sum.audit.copied, 0.5);
  sum.audit.change_p95 = compute_percentile(sum.changes, sum.audit.copied, 0.95);
  return sum.audit;
}

}  // namespace dvi::audit
