#include "common/dds/bus_graph.h"

#include <fnmatch.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <map>

#include "common/base/text.h"
#include "common/dds/schema.h"
#include "common/dds/topic_table.h"

namespace thalweg::dds {
namespace {

constexpr std::string_view kTopicPrefix = "rt/";

const char* TextOf(Durability durability) {
  switch (durability) {
    case Durability::kTransientLocal:
      return "transient local";
    case Durability::kTransient:
      return "transient";
    case Durability::kPersistent:
      return "persistent";
    default:
      return "volatile";
  }
}

const char* TextOf(Liveliness liveliness) {
  switch (liveliness) {
    case Liveliness::kManualByParticipant:
      return "manual by participant";
    case Liveliness::kManualByTopic:
      return "manual by topic";
    default:
      return "automatic";
  }
}

std::string TextOf(const std::optional<Duration>& duration) {
  return duration ? fmt::format("{:.3g} s", Seconds(*duration)) : "infinite";
}

/// Whether an offered period is longer than the one that is requested.
bool IsLonger(const std::optional<Duration>& offered, const std::optional<Duration>& requested) {
  return requested && (!offered || *offered > *requested);
}

/// A policy of a pair that does not fit.
struct Misfit {
  std::string offered, requested, advice;
};

std::vector<Misfit> MisfitsOf(const EndpointQos& offered, const EndpointQos& requested) {
  std::vector<Misfit> misfits;
  const auto add = [&](std::string offer, std::string request, std::string advice) {
    misfits.push_back({std::move(offer), std::move(request), std::move(advice)});
  };
  if (requested.reliable && !offered.reliable) {
    add("best effort", "reliable", "let the reader request best effort, or the writer offer reliable");
  }
  if (requested.durability > offered.durability) {
    add(TextOf(offered.durability), TextOf(requested.durability),
        fmt::format("let the reader request {}, or the writer offer {}", TextOf(offered.durability),
                    TextOf(requested.durability)));
  }
  if (IsLonger(offered.deadline, requested.deadline)) {
    add("a deadline of " + TextOf(offered.deadline), "one of " + TextOf(requested.deadline),
        "let the reader request no deadline, or the writer offer one that is as short");
  }
  if (requested.liveliness > offered.liveliness) {
    add(std::string("liveliness ") + TextOf(offered.liveliness), TextOf(requested.liveliness),
        "let the reader request automatic liveliness");
  }
  if (IsLonger(offered.lease, requested.lease)) {
    add("a liveliness lease of " + TextOf(offered.lease), "one of " + TextOf(requested.lease),
        "let the reader request no lease, or the writer offer one that is as short");
  }
  if (offered.exclusive != requested.exclusive) {
    const auto text = [](bool exclusive) { return exclusive ? "exclusive ownership" : "shared ownership"; };
    add(text(offered.exclusive), text(requested.exclusive), "give both the same ownership");
  }
  if (requested.by_source_stamp && !offered.by_source_stamp) {
    add("order by reception", "order by source stamp", "let the reader request order by reception");
  }
  return misfits;
}

/// Whether two endpoints have a partition in common. Each may be a pattern, but two patterns do not match.
bool ShareAPartition(const Endpoint& a, const Endpoint& b) {
  const std::vector<std::string> none = {""};
  for (const std::string& one : a.partitions.empty() ? none : a.partitions) {
    for (const std::string& other : b.partitions.empty() ? none : b.partitions) {
      if (one == other || fnmatch(one.c_str(), other.c_str(), 0) == 0 ||
          fnmatch(other.c_str(), one.c_str(), 0) == 0) {
        return true;
      }
    }
  }
  return false;
}

/// Which type a topic of the table has on the wire, for whoever has another.
std::string AdviceOnType(const BusGraph& graph, const Endpoint& writer, const Endpoint& reader) {
  const std::optional<std::string> name = TopicName(writer.topic);
  const TopicInfo* const known = name ? FindTopic(*name) : nullptr;
  if (known == nullptr) return "give both the same type";
  const Endpoint& wrong = writer.type == known->type_name ? reader : writer;
  return fmt::format("give {} the type {}, which plain DDS writes as {}", graph.NameOf(wrong.participant),
                     Ros2TypeName(known->type_name), known->type_name);
}

void AddMismatches(const BusGraph& graph, const Endpoint& writer, const Endpoint& reader,
                   std::vector<Mismatch>& out) {
  const std::string topic = ShownTopic(writer.topic);
  const std::string offering = graph.NameOf(writer.participant);
  const std::string requesting = graph.NameOf(reader.participant);
  if (writer.type != reader.type) {
    out.push_back(
        {topic,
         fmt::format("{} publishes {}, {} subscribes {}: nothing passes", offering,
                     CleanText(Ros2TypeName(writer.type)), requesting, CleanText(Ros2TypeName(reader.type))),
         AdviceOnType(graph, writer, reader)});
    return;
  }
  for (const Misfit& misfit : MisfitsOf(writer.qos, reader.qos)) {
    out.push_back({topic,
                   fmt::format("{} offers {}, {} requests {}: nothing passes", offering, misfit.offered,
                               requesting, misfit.requested),
                   misfit.advice});
  }
}

}  // namespace

std::string TextOf(const EndpointQos& qos) {
  std::string text = qos.reliable ? "reliable" : "best effort";
  text += std::string(", ") + TextOf(qos.durability);
  if (qos.deadline) text += ", deadline " + TextOf(qos.deadline);
  if (qos.liveliness != Liveliness::kAutomatic) text += std::string(", liveliness ") + TextOf(qos.liveliness);
  if (qos.lease) text += ", lease " + TextOf(qos.lease);
  if (qos.lifespan) text += ", lifespan " + TextOf(qos.lifespan);
  if (qos.exclusive) text += ", exclusive ownership";
  if (qos.by_source_stamp) text += ", order by source stamp";
  return text;
}

const Participant* BusGraph::Find(const std::string& id) const {
  const auto found = std::ranges::find(participants, id, &Participant::id);
  return found == participants.end() ? nullptr : &*found;
}

std::string BusGraph::NameOf(const std::string& id) const {
  const Participant* const found = Find(id);
  if (found == nullptr || found->name.empty()) return "participant " + id;
  const std::string& place = found->process.empty() ? found->address : found->process;
  return '"' + CleanText(found->name) + '"' + (place.empty() ? "" : " (" + CleanText(place) + ')');
}

std::optional<std::string> TopicName(std::string_view wire_topic) {
  if (!wire_topic.starts_with(kTopicPrefix)) return std::nullopt;
  return std::string(wire_topic.substr(kTopicPrefix.size()));
}

std::string ShownTopic(std::string_view wire_topic) {
  return CleanText(TopicName(wire_topic).value_or(std::string(wire_topic)));
}

std::string WireTopic(std::string_view topic_name) {
  return std::string(kTopicPrefix) + std::string(topic_name);
}

std::vector<Mismatch> FindMismatches(const BusGraph& graph) {
  std::vector<Mismatch> mismatches;
  std::multimap<std::string_view, const Endpoint*> readers;  // by topic
  for (const Endpoint& endpoint : graph.endpoints) {
    if (!endpoint.writes) readers.emplace(endpoint.topic, &endpoint);
  }
  for (const Endpoint& writer : graph.endpoints) {
    if (!writer.writes) continue;
    const auto [begin, end] = readers.equal_range(writer.topic);
    for (auto reader = begin; reader != end; ++reader) {
      if (ShareAPartition(writer, *reader->second)) AddMismatches(graph, writer, *reader->second, mismatches);
    }
  }
  std::ranges::stable_sort(mismatches, {}, &Mismatch::topic);
  return mismatches;
}

}  // namespace thalweg::dds
