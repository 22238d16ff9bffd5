// The tree of frames, as /tf and /tf_static state it.

const MOST_STEPS = 32; // no chain of a robot is as long; ends a walk in a circle

const rotate = ({ x, y, z, w }, v) => {
  // v + 2 q × (q × v + w v), with q the vector part
  const cross = (a, b) => ({ x: a.y * b.z - a.z * b.y, y: a.z * b.x - a.x * b.z, z: a.x * b.y - a.y * b.x });
  const q = { x, y, z }, c = cross(q, v);
  const d = cross(q, { x: c.x + w * v.x, y: c.y + w * v.y, z: c.z + w * v.z });
  return { x: v.x + 2 * d.x, y: v.y + 2 * d.y, z: v.z + 2 * d.z };
};
const multiply = (a, b) => ({
  w: a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
  x: a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
  y: a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
  z: a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w,
});
/** The transform from c to a, by those from b to a and from c to b. */
function compose(aFromB, bFromC) {
  const moved = rotate(aFromB.rotation, bFromC.translation), t = aFromB.translation;
  return { translation: { x: t.x + moved.x, y: t.y + moved.y, z: t.z + moved.z }, rotation: multiply(aFromB.rotation, bFromC.rotation) };
}

export class Transforms {
  #links = new Map(); // child -> { parent, transform: parent from child }

  /** @param message tf2_msgs/msg/TFMessage */
  add(message) {
    for (const { header, child_frame_id: child, transform } of message.transforms) this.#links.set(child, { parent: header.frame_id, transform });
  }
  clear() {
    this.#links.clear();
  }

  /** The pose of `frame` in `ancestor`: { translation, rotation }; null where no chain leads from one to the other. */
  poseOf(frame, ancestor) {
    let pose = { translation: { x: 0, y: 0, z: 0 }, rotation: { x: 0, y: 0, z: 0, w: 1 } };
    for (let step = 0; frame !== ancestor; ++step) {
      const link = this.#links.get(frame);
      if (!link || step === MOST_STEPS) return null;
      pose = compose(link.transform, pose);
      frame = link.parent;
    }
    return pose;
  }
}
