# ONNX Runtime (Debian 13's libonnxruntime-dev) as the imported target onnx::runtime.
include(FindPackageHandleStandardArgs)
find_path(ONNXRUNTIME_INCLUDE_DIR onnxruntime_c_api.h PATH_SUFFIXES onnxruntime onnxruntime/core/session)
find_library(ONNXRUNTIME_LIBRARY onnxruntime)
find_package_handle_standard_args(OnnxRuntime REQUIRED_VARS ONNXRUNTIME_INCLUDE_DIR ONNXRUNTIME_LIBRARY)
if(OnnxRuntime_FOUND AND NOT TARGET onnx::runtime)
  add_library(onnx::runtime UNKNOWN IMPORTED)
  set_target_properties(onnx::runtime PROPERTIES
    IMPORTED_LOCATION ${ONNXRUNTIME_LIBRARY}
    INTERFACE_SYSTEM_INCLUDE_DIRECTORIES ${ONNXRUNTIME_INCLUDE_DIR}
    INTERFACE_INCLUDE_DIRECTORIES ${ONNXRUNTIME_INCLUDE_DIR}
    INTERFACE_COMPILE_DEFINITIONS DVI_LINKS_ONNX_RUNTIME)
endif()
