//===- Messages.h - The messages that a comparison depends on -------------===//
//
// A node gets messages through the callbacks of its subscriptions. From a
// comparison backwards over data and control dependence, this finds the
// callbacks whose messages it depends on: first for the compared value, then
// for whether it is evaluated. The search ends at the callbacks: what makes
// them run is the message.
//
// Dependence is that of BackwardPropagate.h, without what only the contents of
// objects show. Whoever subscribes does not decide about the messages, so that
// places that hand a function on are not followed.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_MESSAGES_H
#define TPC_MESSAGES_H

#include "Options.h"
#include "Rules.h"
#include "calls/SimpleCallGraph.h"
#include "control/IfStatements.h"
#include "memory/VisibleWrites.h"
#include "params/Texts.h"
#include "results/GatherResults.h"
#include "support/DebugTypes.h"

#include "llvm/ADT/MapVector.h"

namespace tpc {

/// A call that subscribes, and what it says.
struct Subscription {
  const llvm::CallBase *At;
  std::string Topic; ///< empty if no constant names it
  std::string Type;  ///< of the messages: `std_msgs/Bool`; empty if not known
};

/// A subscription whose messages a comparison depends on.
struct ReceivedMessage {
  const Subscription *From;
  /// The compared value depends on them; else only whether it is evaluated.
  bool IsValue;
};

class Messages {
public:
  Messages(llvm::Module &M, llvm::ModuleAnalysisManager &AM);

  /// The nearest first, those of the value before the others.
  llvm::SmallVector<ReceivedMessage, 2> of(const Comparison &C);

  /// The type of the message that \p Call, an exposing statement, passes; empty
  /// if it passes none.
  std::string typeOf(const llvm::CallBase &Call) const;

private:
  class Search;
  void addFeeds(UserSources &Sources, const RuleMatches &Rules,
                llvm::ArrayRef<const llvm::CallBase *> Keepers);
  std::string typeOf(const llvm::Value &V) const;

  const CallGraphResult &Calls;
  const IfStatementsResult &Ifs;
  VisibleWrites &Writes;
  DebugTypes &Debug;
  llvm::SmallVector<std::unique_ptr<Subscription>, 8> All;
  llvm::MapVector<const llvm::Function *,
                  llvm::SmallVector<const Subscription *, 1>>
      ByCallback;
};

} // namespace tpc

#endif // TPC_MESSAGES_H
