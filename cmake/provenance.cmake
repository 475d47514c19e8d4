# Writes jaxmpm_git_commit.hpp for lib/core/provenance.cpp at every build, but touches it only when the commit has changed.
# Used twice: included by CMakeLists.txt it adds the target; run with cmake -P it writes the file.
if(CMAKE_SCRIPT_MODE_FILE)
  set(commit "unknown")
  find_program(GIT git)
  if(GIT AND EXISTS ${SOURCE}/.git)
    execute_process(COMMAND ${GIT} -C ${SOURCE} describe --always --abbrev=40 --exclude=* --dirty=+changes OUTPUT_VARIABLE described
                    OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
    if(NOT failed)
      set(commit ${described})
    endif()
  endif()
  file(CONFIGURE OUTPUT ${OUTPUT} CONTENT "#pragma once\n#define JAXMPM_GIT_COMMIT \"${commit}\"\n")
else()
  set(generated ${PROJECT_BINARY_DIR}/generated)
  add_custom_target(
    jaxmpm_git_commit
    COMMAND ${CMAKE_COMMAND} -DSOURCE=${PROJECT_SOURCE_DIR} -DOUTPUT=${generated}/jaxmpm_git_commit.hpp -P ${CMAKE_CURRENT_LIST_FILE}
    BYPRODUCTS ${generated}/jaxmpm_git_commit.hpp
    COMMENT "Noting the git commit")
  add_dependencies(jaxmpm_core jaxmpm_git_commit)
  target_include_directories(jaxmpm_core PRIVATE ${generated})
  set_source_files_properties(lib/core/provenance.cpp PROPERTIES COMPILE_DEFINITIONS
                              "JAXMPM_VERSION=\"${PROJECT_VERSION}\";JAXMPM_BUILD_TYPE=\"${CMAKE_BUILD_TYPE}\"")
endif()
