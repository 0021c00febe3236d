#include "accel/clip_table.h"

#include <span>

#include "shared/animation.h"

namespace helio::accel {
namespace {

static_assert(shared::kTargetScale == static_cast<uint32_t>(scene::ChannelTarget::scale));
static_assert(shared::kTargetWeights == static_cast<uint32_t>(scene::ChannelTarget::weights));
static_assert(shared::kInterpolateCubic == static_cast<uint32_t>(scene::Interpolation::cubic_spline));

/// One buffer's bytes; tables in it are known by offset until the buffer has its address.
class Arena {
 public:
  template <typename T>
  uint64_t append(std::span<const T> items) {
    bytes_.resize(gpu::alignUp(bytes_.size(), size_t{16}));
    const uint64_t at = bytes_.size();
    const auto raw = std::as_bytes(items);
    bytes_.insert(bytes_.end(), raw.begin(), raw.end());
    return at;
  }
  const std::vector<std::byte>& bytes() const { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
};

void rowsOf(const glm::mat4x3& m, glm::vec4 (&rows)[3]) {
  for (int row = 0; row < 3; ++row) rows[row] = {m[0][row], m[1][row], m[2][row], m[3][row]};
}

/// The tables of one clip; addresses are offsets in the arena.
shared::ClipRecord append(Arena& arena, const scene::Rig& rig, const scene::Clip& clip) {
  std::vector<float> numbers;
  std::vector<shared::ChannelRecord> channels;
  const auto add = [&](const scene::Channel& channel) {
    shared::ChannelRecord record{};
    record.target = static_cast<uint32_t>(channel.target);
    record.interpolation = static_cast<uint32_t>(channel.interpolation);
    record.first_time = static_cast<uint32_t>(numbers.size());
    record.key_count = static_cast<uint32_t>(channel.times.size());
    numbers.insert(numbers.end(), channel.times.begin(), channel.times.end());
    record.first_value = static_cast<uint32_t>(numbers.size());
    numbers.insert(numbers.end(), channel.values.begin(), channel.values.end());
    channels.push_back(record);
  };
  std::vector<shared::ClipNode> nodes;
  for (uint32_t n = 0; n < rig.nodes.size(); ++n) {
    const scene::RigNode& from = rig.nodes[n];
    shared::ClipNode node{};
    rowsOf(from.rest, node.rest);
    node.translation = from.translation;
    node.rotation = {from.rotation.x, from.rotation.y, from.rotation.z, from.rotation.w};
    node.scale = from.scale;
    node.parent = from.parent == scene::kNone ? shared::kNoNode : from.parent;
    node.first_channel = static_cast<uint32_t>(channels.size());
    for (const scene::Channel& channel : clip.channels)
      if (channel.node == n && channel.target != scene::ChannelTarget::weights) add(channel);
    node.channel_count = static_cast<uint32_t>(channels.size()) - node.first_channel;
    nodes.push_back(node);
  }
  shared::ClipRecord record{};
  record.weight_channel = shared::kNoNode;
  for (const scene::Channel& channel : clip.channels) {
    if (channel.target != scene::ChannelTarget::weights) continue;
    record.weight_channel = static_cast<uint32_t>(channels.size());
    add(channel);
  }
  record.rest_weights = static_cast<uint32_t>(numbers.size());
  numbers.insert(numbers.end(), rig.weights.begin(), rig.weights.end());
  std::vector<shared::JointRecord> joints;
  for (const scene::Joint& joint : rig.joints) {
    joints.push_back({{}, joint.node});
    rowsOf(joint.inverse_bind, joints.back().inverse_bind);
  }
  record.nodes = arena.append<shared::ClipNode>(nodes);
  record.channels = arena.append<shared::ChannelRecord>(channels);
  record.joints = arena.append<shared::JointRecord>(joints);
  record.numbers = arena.append<float>(numbers);
  record.node_count = static_cast<uint32_t>(nodes.size());
  record.joint_count = static_cast<uint32_t>(joints.size());
  record.weight_count = static_cast<uint32_t>(rig.weights.size());
  return record;
}

}  // namespace

ClipTable::ClipTable(gpu::Device& device, gpu::Commands& commands, const scene::Scene& scene) {
  Arena arena;
  std::vector<shared::ClipRecord> records;
  for (const scene::Rig& rig : scene.rigs)
    for (const scene::Clip& clip : rig.clips) records.push_back(append(arena, rig, clip));
  shared::GroundRecord ground{};
  if (scene.ground.columns > 0) {
    const auto rows = static_cast<uint32_t>(scene.ground.heights.size() / scene.ground.columns);
    ground = {arena.append<float>(scene.ground.heights), scene.ground.origin, scene.ground.spacing,
              scene.ground.columns, rows};
  }
  const uint64_t bytes = gpu::alignUp(arena.bytes().size(), size_t{16});
  const uint64_t ground_at = bytes + records.size() * sizeof(shared::ClipRecord);
  buffer_ = gpu::Buffer(device, {"the clips", ground_at + sizeof(shared::GroundRecord), gpu::MemoryCategory::raster});
  for (shared::ClipRecord& record : records)
    for (uint64_t* table : {&record.nodes, &record.channels, &record.joints, &record.numbers})
      *table += buffer_.address();
  ground.heights += buffer_.address();
  if (!arena.bytes().empty()) commands.upload(buffer_, 0, arena.bytes());
  if (!records.empty()) commands.upload(buffer_, bytes, std::as_bytes(std::span(records)));
  commands.upload(buffer_, ground_at, std::as_bytes(std::span(&ground, 1)));
  if (scene.ground.columns > 0) ground_ = buffer_.address() + ground_at;

  size_t next = 0;
  for (const scene::Rig& rig : scene.rigs) {
    addresses_.emplace_back();
    for (size_t c = 0; c < rig.clips.size(); ++c)
      addresses_.back().push_back(buffer_.address() + bytes + next++ * sizeof(shared::ClipRecord));
  }
}

}  // namespace helio::accel
