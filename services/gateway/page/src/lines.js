// Lines of a width in pixels: the paths.
import { Line2 } from "three/addons/lines/Line2.js";
import { LineGeometry } from "three/addons/lines/LineGeometry.js";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { LineSegmentsGeometry } from "three/addons/lines/LineSegmentsGeometry.js";

export class FatLine {
  constructor(width) {
    this.material = new LineMaterial({ linewidth: width, worldUnits: false });
    this.line = new Line2(new LineGeometry(), this.material);
    this.line.visible = false;
    this.line.frustumCulled = false;
  }
  /** @param points flat x, y, z; @param breaks numbers of points to which no line leads */
  set(points, breaks = new Set()) {
    const pairs = [];
    for (let n = 1; n < points.length / 3; ++n) {
      if (!breaks.has(n)) for (let k = 3 * n - 3; k < 3 * n + 3; ++k) pairs.push(points[k]);
    }
    this.line.visible = pairs.length > 0;
    if (!this.line.visible) return;
    this.line.geometry.dispose();
    this.line.geometry = new LineSegmentsGeometry();
    this.line.geometry.setPositions(pairs);
  }
  /** How many pieces of it are drawn. */
  get pieces() {
    return this.line.visible && this.material.visible ? this.line.geometry.getAttribute("instanceStart").count : 0;
  }
}
