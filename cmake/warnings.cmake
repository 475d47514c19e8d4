# Flags of our own code only: warnings are errors, no fast-math that assumes finite values.
add_library(jaxmpm_warnings INTERFACE)
set(jaxmpm_host_flags -Wall -Wextra -Werror -Wno-psabi -Wno-ignored-attributes -fno-math-errno -fno-trapping-math)
if(JAXMPM_ARCH)
  list(APPEND jaxmpm_host_flags -march=${JAXMPM_ARCH})
elseif(JAXMPM_NATIVE)
  list(APPEND jaxmpm_host_flags -march=native)
endif()
target_compile_options(jaxmpm_warnings INTERFACE ${jaxmpm_host_flags})
if(JAXMPM_SANITIZE)
  # Their instrumentation makes GCC see uninitialised values in the standard library where there are none.
  target_compile_options(jaxmpm_warnings INTERFACE -Wno-maybe-uninitialized)
  set(CMAKE_CXX_FLAGS_RELWITHDEBINFO "-O1")  # instrumented kernels compile in half the time of -O2, and asserts stay
  add_compile_options(-fsanitize=${JAXMPM_SANITIZE} -fno-omit-frame-pointer -g)
  add_link_options(-fsanitize=${JAXMPM_SANITIZE})
endif()
