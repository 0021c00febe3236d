// Tells ThreadSanitizer what orders threads inside gRPC and Abseil, which Debian builds without it: the mutexes of
// Abseil (also behind gpr_mu), that a batch of operations is begun before it is done, and that a request is made before
// it is answered. Loaded with LD_PRELOAD by tests/sanitize/run. With it a race between our threads and gRPC's is found,
// and what gRPC orders is no race.
#include <absl/synchronization/mutex.h>
#include <dlfcn.h>
#include <grpc/grpc.h>
#include <grpcpp/support/server_callback.h>
#include <link.h>

extern "C" {
// Missing in programs that are not instrumented: shells, for example.
void __tsan_acquire(void* address) __attribute__((weak));
void __tsan_release(void* address) __attribute__((weak));
}

namespace {

void acquire(void* address) {
  if (__tsan_acquire) __tsan_acquire(address);
}
void release(void* address) {
  if (__tsan_release) __tsan_release(address);
}

/// The function that `own` stands before, by its mangled name: Abseil's has the distribution's version in it.
template <typename Function>
Function behind(void* own) {
  Dl_info info{};
  dladdr(own, &info);
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, info.dli_sname));
}

/// `address` is code, and not a table of virtual functions.
bool isCode(const void* address) {
  const auto contains = [](dl_phdr_info* object, size_t, void* sought) {
    const auto where = reinterpret_cast<ElfW(Addr)>(sought);
    for (int i = 0; i < object->dlpi_phnum; ++i) {
      const auto& segment = object->dlpi_phdr[i];
      const auto begin = object->dlpi_addr + segment.p_vaddr;
      if (segment.p_type == PT_LOAD && (segment.p_flags & PF_X) && where >= begin && where < begin + segment.p_memsz)
        return 1;
    }
    return 0;
  };
  return dl_iterate_phdr(contains, const_cast<void*>(address)) != 0;
}

/// Stands in for the functor of a batch until the batch is done.
struct Done : grpc_completion_queue_functor {
  explicit Done(grpc_completion_queue_functor* of) : of(of) {
    functor_run = [](grpc_completion_queue_functor* self, int ok) {
      auto* of = static_cast<Done*>(self)->of;
      acquire(of);
      delete static_cast<Done*>(self);
      of->functor_run(of, ok);
    };
    inlineable = of->inlineable;
    internal_success = 0;
    internal_next = nullptr;
  }
  grpc_completion_queue_functor* const of;
};

}  // namespace

#define BEHIND(Type, function) static const auto real = behind<Type>(reinterpret_cast<void*>(function))

// ---- Abseil

void absl::Mutex::Lock() {
  BEHIND(void (*)(Mutex*), &Mutex::Lock);
  real(this);
  acquire(this);
}

void absl::Mutex::Unlock() {
  BEHIND(void (*)(Mutex*), &Mutex::Unlock);
  release(this);
  real(this);
}

bool absl::Mutex::TryLock() {
  BEHIND(bool (*)(Mutex*), &Mutex::TryLock);
  const bool locked = real(this);
  if (locked) acquire(this);
  return locked;
}

void absl::Mutex::ReaderLock() {
  BEHIND(void (*)(Mutex*), &Mutex::ReaderLock);
  real(this);
  acquire(this);
}

void absl::Mutex::ReaderUnlock() {
  BEHIND(void (*)(Mutex*), &Mutex::ReaderUnlock);
  release(this);
  real(this);
}

void absl::CondVar::Wait(Mutex* mutex) {
  BEHIND(void (*)(CondVar*, Mutex*), &CondVar::Wait);
  release(mutex);
  real(this, mutex);
  acquire(mutex);
}

bool absl::CondVar::WaitWithTimeout(Mutex* mutex, absl::Duration timeout) {
  BEHIND(bool (*)(CondVar*, Mutex*, absl::Duration), &CondVar::WaitWithTimeout);
  release(mutex);
  const bool late = real(this, mutex, timeout);
  acquire(mutex);
  return late;
}

bool absl::CondVar::WaitWithDeadline(Mutex* mutex, absl::Time deadline) {
  BEHIND(bool (*)(CondVar*, Mutex*, absl::Time), &CondVar::WaitWithDeadline);
  release(mutex);
  const bool late = real(this, mutex, deadline);
  acquire(mutex);
  return late;
}

// ---- gRPC

/// All reactions of a call are over. Those that ended in gRPC's own copy of this count were not seen.
void grpc::internal::ServerCallbackCall::ScheduleOnDone(bool inline_ondone) {
  BEHIND(void (*)(ServerCallbackCall*, bool), &ServerCallbackCall::ScheduleOnDone);
  acquire(&callbacks_outstanding_);
  real(this, inline_ondone);
}

// A tag is a functor where callbacks are used, and an object with virtual functions in a queue that is polled.

extern "C" grpc_call_error grpc_call_start_batch(grpc_call* call, const grpc_op* ops, size_t count, void* tag,
                                                 void* reserved) {
  BEHIND(decltype(&grpc_call_start_batch), &grpc_call_start_batch);
  if (!tag || !isCode(*static_cast<void**>(tag))) {
    release(tag);
    return real(call, ops, count, tag, reserved);
  }
  auto* done = new Done(static_cast<grpc_completion_queue_functor*>(tag));
  release(tag);
  const auto error = real(call, ops, count, done, reserved);
  if (error != GRPC_CALL_OK) delete done;
  return error;
}

/// A request is made, and its interceptors with it, by whatever thread finds that a call has arrived; then a queue
/// without locks takes it to the thread that answers it. One name for all of them: which array is whose request's is
/// gRPC's secret.
char requests = 0;

extern "C" void grpc_metadata_array_init(grpc_metadata_array* array) {
  BEHIND(decltype(&grpc_metadata_array_init), &grpc_metadata_array_init);
  real(array);
  release(&requests);
}

extern "C" grpc_event grpc_completion_queue_next(grpc_completion_queue* queue, gpr_timespec deadline, void* reserved) {
  BEHIND(decltype(&grpc_completion_queue_next), &grpc_completion_queue_next);
  const grpc_event event = real(queue, deadline, reserved);
  if (event.type == GRPC_OP_COMPLETE) {
    acquire(event.tag);
    acquire(&requests);
  }
  return event;
}

extern "C" grpc_event grpc_completion_queue_pluck(grpc_completion_queue* queue, void* tag, gpr_timespec deadline,
                                                  void* reserved) {
  BEHIND(decltype(&grpc_completion_queue_pluck), &grpc_completion_queue_pluck);
  const grpc_event event = real(queue, tag, deadline, reserved);
  if (event.type == GRPC_OP_COMPLETE) acquire(event.tag);
  return event;
}
