#include "dvi/objects/detect/description.h"
#include "parser.h"

// MODEL.toml.
void dvi::fuzz::parse(const fs::path& folder, const std::string& bytes) {
  put(folder / "net.toml", bytes);
  const objects::Description read = objects::read_description(folder / "net.onnx");
  require(!read.classes.empty() && read.removed.size() == read.classes.size(), "every class is removed or not");
  require(read.input.area() > 0 && read.sigma[0] > 0, "images can be brought to the input");
}
