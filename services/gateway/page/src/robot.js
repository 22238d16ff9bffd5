// The robot as the scenario describes it.

/**
 * @param parameters name -> value, as the gateway gives them: defaults included
 * @returns { radius, height [m], 0 = a sphere, fovDeg: horizontal field of view, aspect: width by height, bodyFrame,
 *            cameraFrame: as they are called on the wire }
 */
export function robotFrom(parameters) {
  const get = (name) => {
    if (!parameters.has(name)) throw new Error(`the gateway gives no parameter ${name}`);
    return parameters.get(name);
  };
  const name = get("robot.name");
  const wire = (frame) => (name ? `${name}/${frame}` : frame);
  return {
    radius: get("robot.radius_m"),
    height: get("robot.height_m"),
    fovDeg: get("depth_sensor.horizontal_fov_deg"),
    aspect: get("depth_sensor.width_px") / get("depth_sensor.height_px"),
    bodyFrame: wire(get("frames.base_link")),
    cameraFrame: wire(get("frames.camera")),
  };
}
