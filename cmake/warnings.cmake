# Flags of our own code only: warnings are errors, no fast-math that assumes finite values.
add_library(jaxmpm_warnings INTERFACE)
set(jaxmpm_host_flags -Wall -Wextra -Werror -Wno-psabi -Wno-ignored-attributes -fno-math-errno -fno-trapping-math)
if(JAXMPM_ARCH)
  list(APPEND jaxmpm_host_flags -march=${JAXMPM_ARCH})
elseif(JAXMPM_NATIVE)
  list(APPEND jaxmpm_host_flags -march=native)
endif()
# Copies of packs in one move. GCC copies in pieces of 16 or 32 bytes on many processors, and a load of a whole register from what was stored in
# pieces waits until they have reached the cache: half of the time of a step.
include(CheckCXXCompilerFlag)
foreach(flag -mmove-max=512 -mstore-max=512)
  string(MAKE_C_IDENTIFIER "JAXMPM_HAS${flag}" known)
  check_cxx_compiler_flag(${flag} ${known})
  if(${known})
    list(APPEND jaxmpm_host_flags ${flag})
  endif()
endforeach()
# Loops over lanes in whole registers, as wide as the packs around them: GCC prefers 32 bytes on many processors with AVX-512, and again a
# load of 64 bytes waits for two stores of 32.
check_cxx_compiler_flag(-mprefer-vector-width=512 JAXMPM_HAS_vector_width)
if(JAXMPM_HAS_vector_width)
  list(APPEND jaxmpm_host_flags -mprefer-vector-width=512)
endif()
target_compile_options(jaxmpm_warnings INTERFACE ${jaxmpm_host_flags})
if(JAXMPM_SANITIZE)
  # Their instrumentation makes GCC see uninitialised values in the standard library where there are none.
  target_compile_options(jaxmpm_warnings INTERFACE -Wno-maybe-uninitialized)
  set(CMAKE_CXX_FLAGS_RELWITHDEBINFO "-O0")  # instrumented templates take minutes to optimise; rooms that compute are optimised (rooms.cmake)
  # -g1 gives places for the reports; following every variable, as -g after it would, makes the kernels compile three times as long.
  add_compile_options(-fsanitize=${JAXMPM_SANITIZE} -fno-omit-frame-pointer -g1)
  add_link_options(-fsanitize=${JAXMPM_SANITIZE})
endif()
