# The few parts of OpenCV that dvi uses, as imported targets opencv::core and so on.
# Debian ships OpenCVConfig.cmake only with all of OpenCV (VTK and Qt included: more than a gigabyte).
include(FindPackageHandleStandardArgs)
find_path(OPENCV_INCLUDE_DIR opencv2/core.hpp PATH_SUFFIXES opencv4)
set(OPENCV_PARTS core imgproc imgcodecs video photo dnn)
foreach(part ${OPENCV_PARTS})
  find_library(OPENCV_${part}_LIBRARY opencv_${part})
  list(APPEND OPENCV_VARIABLES OPENCV_${part}_LIBRARY)
  if(OPENCV_${part}_LIBRARY AND NOT TARGET opencv::${part})
    add_library(opencv::${part} UNKNOWN IMPORTED)
    set_target_properties(opencv::${part} PROPERTIES
      IMPORTED_LOCATION ${OPENCV_${part}_LIBRARY}
      INTERFACE_SYSTEM_INCLUDE_DIRECTORIES ${OPENCV_INCLUDE_DIR}
      INTERFACE_INCLUDE_DIRECTORIES ${OPENCV_INCLUDE_DIR})
  endif()
endforeach()
find_package_handle_standard_args(OpenCVParts REQUIRED_VARS OPENCV_INCLUDE_DIR ${OPENCV_VARIABLES})
