// The sliders at the left: the height above which the map is cut, and that of the slice through the field.
const $ = (id) => document.getElementById(id);

export class Heights {
  #seen = "";
  #sliceMoved = false; // until then the slice is at the robot

  /** @param robot () => position of the robot, or null */
  constructor(scene, robot) {
    Object.assign(this, { scene, robot });
    $("cut").oninput = () => this.#drawCut();
    $("slice-height").oninput = () => {
      this.#sliceMoved = true;
      scene.sliceField(this.slice());
    };
  }

  /** Fits the sliders to the map, whenever it reaches lower or higher. */
  fit() {
    const { low, high } = this.scene.map;
    if (`${low} ${high}` === this.#seen) return;
    this.#seen = `${low} ${high}`;
    this.#drawCut();
  }

  moveCut(by) {
    $("cut").value = Number($("cut").value) + by;
    this.#drawCut();
  }
  #drawCut() {
    const { low, high, uniforms } = this.scene.map;
    if (!Number.isFinite(low)) return;
    const share = $("cut").value / 1000, height = low + (high - low) * share;
    uniforms.low.value = low;
    uniforms.high.value = high;
    this.scene.setCut(share >= 1 ? 1e9 : height);
    $("cut-value").textContent = share >= 1 ? "none" : `${height.toFixed(2)} m`;
    $("legend-low").textContent = `${low.toFixed(1)} m`;
    $("legend-high").textContent = `${high.toFixed(1)} m`;
  }

  /** The height of the slice [m], which is shown as well; not finite without a map. */
  slice() {
    const { low, high } = this.scene.map, robot = this.robot();
    if (!this.#sliceMoved && robot && high > low) $("slice-height").value = Math.round((1000 * (robot.z - low)) / (high - low));
    const height = low + ((high - low) * $("slice-height").value) / 1000;
    $("slice-value").textContent = Number.isFinite(height) ? `${height.toFixed(2)} m` : "–";
    return height;
  }
}
