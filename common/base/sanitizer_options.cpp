// Options for the sanitizers, linked into every program of a sanitized build. They concern libraries of
// others, which are not instrumented.

#ifdef THALWEG_SANITIZE_ADDRESS
// Fast DDS 2.9 deletes readers through a base class of another size.
extern "C" const char* __asan_default_options() {
  return "new_delete_type_mismatch=0";
}
#endif

#ifdef THALWEG_SANITIZE_THREAD
extern "C" const char* __tsan_default_suppressions() {
  // Fast DDS takes its own locks in varying order and by calls that ThreadSanitizer does not know.
  return "mutex:libfastrtps\ndeadlock:libfastrtps\nrace:libfastrtps\n"
         // Its static variable is created in a library that is not instrumented.
         "race:spdlog::details::registry\n"
         // Cyclone DDS, the peer of some tests, moves its buffers between threads.
         "race:libddsc\n"
         // OpenCV reads image files by it.
         "deadlock:libgdal\n";
}
#endif
