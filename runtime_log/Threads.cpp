//===- Threads.cpp --------------------------------------------------------===//
#include "Threads.h"

#include <new>
#include <pthread.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace tpc {

__thread Thread *ThisThread = nullptr;

namespace {

struct Registry {
  std::mutex Lock;
  std::vector<Thread *> All;
  std::vector<Thread *> Free;
  pthread_key_t Key;
  /// If a program has used up all keys, threads do not reuse each other's
  /// place.
  bool HasKey;

  Registry() {
    HasKey = !pthread_key_create(&Key, [](void *T) {
      ThisThread = nullptr;
      std::lock_guard<std::mutex> Guard(of().Lock);
      of().Free.push_back(static_cast<Thread *>(T));
    });
  }

  /// Never destroyed: threads report until the process ends.
  static Registry &of() {
    static auto *R = new Registry;
    return *R;
  }
};

} // namespace

Thread *makeThread() {
  Registry &R = Registry::of();
  Thread *T = nullptr;
  {
    std::lock_guard<std::mutex> Guard(R.Lock);
    if (R.Free.empty()) {
      T = new Thread;
      T->Number = static_cast<uint32_t>(R.All.size() + 1);
      R.All.push_back(T);
    } else {
      T = R.Free.back();
      R.Free.pop_back();
    }
  }
  T->Tid = static_cast<uint64_t>(syscall(SYS_gettid));
  if (R.HasKey)
    pthread_setspecific(R.Key, T);
  return ThisThread = T;
}

std::vector<Thread *> allThreads() {
  Registry &R = Registry::of();
  std::lock_guard<std::mutex> Guard(R.Lock);
  return R.All;
}

void lockThreads() { Registry::of().Lock.lock(); }
void unlockThreads() { Registry::of().Lock.unlock(); }

void threadsAfterFork() {
  Registry &R = Registry::of();
  R.Free.clear();
  for (Thread *T : R.All) {
    new (&T->Lock) std::mutex;
    // Chunks and slots belong to the parent, which continues to write them.
    T->Next = T->End = nullptr;
    T->File = nullptr;
    T->PairsHome = nullptr;
    T->Pairs = nullptr;
    T->PairCount = 0;
    T->Written = 0;
    T->Simulated = -1;
    T->Nested = 0;
    T->Inside = 0;
    T->Touched[0].clear();
    T->Touched[1].clear();
    if (T != ThisThread)
      R.Free.push_back(T);
    else
      T->Tid = static_cast<uint64_t>(syscall(SYS_gettid));
  }
}

} // namespace tpc
