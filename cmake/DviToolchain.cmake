# Compiler and linker settings that hold for every target of the project.
add_library(dvi_settings INTERFACE)
add_library(dvi::settings ALIAS dvi_settings)
target_include_directories(dvi_settings INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src> $<INSTALL_INTERFACE:include>)
target_compile_options(dvi_settings INTERFACE
  "$<BUILD_INTERFACE:-Wall;-Wextra;-Wpedantic;-Wshadow;-Wconversion;-Wno-sign-conversion>"
  # GCC 12 raises these falsely inside its own string and inside fmt.
  "$<BUILD_INTERFACE:$<$<CXX_COMPILER_ID:GNU>:-Wno-restrict;-Wno-stringop-overflow>>")
# The same bytes on every machine: no fused multiply-add where the source has none.
target_compile_options(dvi_settings INTERFACE -ffp-contract=off)
# For the modules that include toml++, which asserts that a key follows each '['. A file where none does must be refused
# (core/toml_file.h), not end the program.
set(DVI_TOML "-DTOML_ASSERT(holds)=((holds) ? void() : throw std::runtime_error(#holds))" $<$<CXX_COMPILER_ID:GNU>:-Wno-terminate>)
if(DVI_SANITIZE)  # its tables call letters from U+00A1 on unreachable
  list(APPEND DVI_TOML -fno-sanitize=unreachable)
endif()

find_program(DVI_CCACHE ccache)
if(DVI_CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${DVI_CCACHE})
endif()
find_program(DVI_MOLD mold)
if(DVI_MOLD)
  add_link_options(-fuse-ld=mold)
endif()
# Drives come from strangers (SECURITY.md). Calls into libraries are bound at the start, and their table is read-only from then on.
add_link_options(-Wl,-z,relro,-z,now)
if(DVI_SANITIZE)
  add_compile_options(-fsanitize=${DVI_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${DVI_SANITIZE})
else()
  # Code lies at another address each time, and an overwritten stack or buffer ends the program. The sanitizers see more.
  # -fPIC, not -fPIE, so that the Python module is linked from the same objects; with hidden symbols the code is the same.
  add_compile_options(-fPIC -fvisibility=hidden -fstack-protector-strong $<$<CONFIG:Release>:-U_FORTIFY_SOURCE> $<$<CONFIG:Release>:-D_FORTIFY_SOURCE=2>)
  add_link_options($<$<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>:-pie>)
endif()
