#include "dvi/cli/job_options.h"

#include <stdexcept>

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/result/plan_manifest.h"

namespace dvi::cli {
namespace {

// Left alone where there is nothing: the message is to name what was typed.
void make_absolute(std::string& path) {
  if (!path.empty() && fs::exists(path)) path = fs::absolute(path).lexically_normal().string();
}

// What stands behind a flag, in the type of its field.
template <class Choice, class Parse>
void take(const std::optional<std::string>& text, const char* flag, Parse parse, Choice& field) {
  if (!text) return;
  try {
    field = parse(*text);
  } catch (const std::invalid_argument& e) {
    throw UsageError(fmt::format("{} {}: {}", flag, *text, e.what()));
  }
}

}  // namespace

void JobOptions::add_to(Command& command) {
  command.option("--frames", frames, "A:B: only these frames, inclusive, by the drive's own numbers; A: only that frame");
  command.option("--camera", camera, "Camera to use (default: the drive's first)");
  command.option("--topic", topics,
                 "Of a bag: image=TOPIC, points=TOPIC, depth=TOPIC, info=TOPIC, poses=TOPIC, repeatable (default: guessed)");
  command.option("--sources", source_cameras, "Other cameras of the drives to copy from: all (default), none, or NAME,NAME");
  command.option(
      "--masks", masks,
      "What to remove: DIR (PNG masks, LabelMe), FILE (labels: KITTI, MOTS, COCO, CVAT, boxes.json), labels, found, auto");
  command.option("--polarity", polarity, "Of PNG masks: white = remove, black = remove, or auto (default: by their shares)");
  command.option("--classes", classes,
                 "Of masks that are pictures of class ids, or of labels: car,truck or semantic-kitti:car or 26,27");
  command.option("--ego-mask", ego_mask, "PNG of what hides the view in every frame, such as the hood; it is removed too");
  command.option("--detector", detector, "What to remove: what a network of yours sees, MODEL.onnx with MODEL.toml beside it");
  command.option("--poses", poses,
                 "auto (default: given or loam, whichever map is sharper), given, loam (estimated from scans), or FILE");
  command.option("--remove", remove, "moving, labeled (default: what the masks say), or all (masks and every labeled object)");
  command.option("--unobserved", unobserved,
                 "Pixels that no frame saw: synthesize (default), interpolate from their surroundings, or leave (black)");
  command.option("--method", method,
                 "dvi (default), paper (the published form), or a baseline without depth and poses: flow, telea, ns");
  command.option("--config", config, "Options from a TOML file, such as the dvi.toml of an earlier result");
  command.option("--set", set, "section.key=value, repeatable; dvi config dump --all lists all options");
}

job::Job JobOptions::job(const std::string& out, const std::string& target, const std::vector<std::string>& sources) const {
  job::Job job;
  OptionTable table = job.table();
  if (!config.empty()) table.load_toml(config);
  take(method, "--method", parse_name<job::Method>, job.method);
  job::use_method(job.method, job.options);
  // Once more: what the file says of single options holds against the method it names.
  if (!config.empty() && !method) table.load_toml(config);
  if (camera) job.read.camera = *camera;
  if (!topics.empty()) job.read.topics = topics;
  if (source_cameras) job.read.source_cameras = *source_cameras;
  if (frames) job.read.frames = *frames;
  if (masks && detector) throw UsageError("--detector and --masks both say what to remove: give one of them");
  if (masks) job.read.detector.clear();  // what a file says of the other
  if (detector) job.read.masks = {};
  take(masks, "--masks", job::MasksFrom::parse, job.read.masks);
  if (detector) job.read.detector = *detector;
  take(polarity, "--polarity", parse_name<labels::Polarity>, job.read.mask_files.polarity);
  if (classes) job.read.mask_files.classes = *classes;
  if (ego_mask) job.read.ego_mask = *ego_mask;
  take(poses, "--poses", job::PosesFrom::parse, job.read.poses);
  take(remove, "--remove", job::parse_remove, job.read.remove);
  take(unobserved, "--unobserved", parse_name<harmonize::Unobserved>, job.options.harmonize.unobserved);
  for (const std::string& assignment : set) table.set(assignment);
  job.options.check();
  if (!out.empty()) job.out = out;
  if (!target.empty()) {
    job.target = target;
    job.sources = sources;
  }
  for (std::string* path : {&job.target, &job.read.masks.path, &job.read.ego_mask, &job.read.detector, &job.read.poses.file})
    make_absolute(*path);
  for (std::string& path : job.sources) make_absolute(path);
  return job;
}

void RunArguments::add_to(Command& command) {
  command.positional("TARGET", target, "The drive to clean", false);
  command.positional("SOURCE", sources, "Source drives of the same street to copy pixels from");
  command.option("-o,--out", out, "Folder of the result");
  options.add_to(command);
  command.flag("--force", force, "Replace a result of another drive");
  common.add_to(command, true);
}

job::Job RunArguments::job(const std::string& command) {
  job::Job job = options.job(out, target, sources);
  job.force = force;
  out = job.out;
  if (job.target.empty()) throw UsageError(fmt::format("dvi {0} needs a drive: dvi {0} TARGET -o OUT", command));
  if (job.out.empty()) throw UsageError(fmt::format("dvi {} needs a folder for the result: -o OUT", command));
  return job;
}

job::Job planned_job(const std::string& out) {
  result::read_plan(out);
  JobOptions options;
  options.config = (fs::path(out) / "dvi.toml").string();
  return options.job(fs::absolute(out).lexically_normal().string(), "", {});
}

}  // namespace dvi::cli
