# The CUDA backend: where Kokkos has CUDA, the .cu files of a room are compiled as well, as C++ by Kokkos's nvcc_wrapper.
set(JAXMPM_CUDA OFF)
if("CUDA" IN_LIST Kokkos_DEVICES)
  set(JAXMPM_CUDA ON)
  if(NOT CMAKE_CXX_COMPILER MATCHES "nvcc_wrapper|kokkos_launch_compiler|clang")
    message(FATAL_ERROR "This Kokkos has CUDA: configure with -DCMAKE_CXX_COMPILER=<its bin folder>/nvcc_wrapper, as scripts/build-cuda does.")
  endif()
  unset(CMAKE_CXX_COMPILER_LAUNCHER)  # ccache takes the wrapper for a host compiler
  add_compile_options(--expt-relaxed-constexpr  # std::array in kernels
                      "SHELL:-Xcudafe --diag_suppress=177"  # unused variables of discarded branches; g++ itself says what matters
                      "SHELL:-Xcudafe --diag_error=20011" "SHELL:-Xcudafe --diag_error=20014")  # calls of functions that a device does not have
endif()

# Sources of a pattern that only CUDA builds have.
function(jaxmpm_cuda_sources variable pattern)
  set(sources)
  if(JAXMPM_CUDA)
    file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${pattern})
    set_source_files_properties(${sources} PROPERTIES LANGUAGE CXX COMPILE_DEFINITIONS JAXMPM_DEVICE_CODE)
  endif()
  set(${variable} ${sources} PARENT_SCOPE)
endfunction()

# In CUDA builds the host compiler takes the sources of a target that never includes Kokkos: it is quicker than nvcc and warns of what is there.
function(jaxmpm_host_only target)
  if(JAXMPM_CUDA)
    target_compile_options(${target} PRIVATE --host-only)
  endif()
endfunction()

# What CI compiles: the stepper, and quadratic splines with apic and flip, in both precisions and dimensions.
function(jaxmpm_cuda_subset)
  if(JAXMPM_CUDA)
    jaxmpm_cuda_sources(kernels ${PROJECT_SOURCE_DIR}/lib/kernels/device/*_quadratic.cu)
    add_library(jaxmpm_cuda_subset OBJECT EXCLUDE_FROM_ALL ${kernels} ${PROJECT_SOURCE_DIR}/lib/solvers/device_step.cu
                                                           ${PROJECT_SOURCE_DIR}/lib/solvers/device_reversible_step.cu
                                                           ${PROJECT_SOURCE_DIR}/lib/solvers/state_memory.cpp
                                                           ${PROJECT_SOURCE_DIR}/lib/solvers/solver.cpp)
    target_compile_definitions(jaxmpm_cuda_subset PRIVATE JAXMPM_CUDA_SUBSET)
    target_link_libraries(jaxmpm_cuda_subset PRIVATE jaxmpm_solvers jaxmpm_warnings)
  endif()
endfunction()
