// What a message of /thalweg/surface says, and blocks as one mesh.
const PER_CHUNK = 4; // blocks along each axis: one draw call for what is seen at once

/** Where blocks and their chunks are in the arrays of a message of /thalweg/surface. */
export function* blocksOf(message) {
  let vertex = 0, triangle = 0;
  for (let n = 0; n < message.vertices.length; ++n) {
    const vertices = message.vertices[n], triangles = message.triangles[n];
    const three = (array) => array.slice(3 * vertex, 3 * (vertex + vertices));
    const place = message.position.slice(3 * n, 3 * n + 3);
    yield { key: place.join(), chunk: [...place].map((c) => Math.floor(c / PER_CHUNK)).join(), points: three(message.points_m),
      normals: three(message.normals), colors: three(message.colors), views: message.views.slice(vertex, vertex + vertices),
      faces: message.faces.slice(3 * triangle, 3 * (triangle + triangles)) };
    vertex += vertices;
    triangle += triangles;
  }
}

/** The arrays of several blocks as one mesh. */
export function joined(blocks) {
  const vertices = blocks.reduce((sum, { views }) => sum + views.length, 0);
  const corners = blocks.reduce((sum, { faces }) => sum + faces.length, 0);
  const mesh = { points: new Float32Array(3 * vertices), normals: new Uint8Array(3 * vertices), colors: new Uint8Array(3 * vertices),
    views: new Uint8Array(vertices), faces: new Uint32Array(corners) };
  let first = 0, corner = 0;
  for (const block of blocks) {
    for (const name of ["points", "normals", "colors"]) mesh[name].set(block[name], 3 * first);
    mesh.views.set(block.views, first);
    for (const vertex of block.faces) mesh.faces[corner++] = first + vertex;
    first += block.views.length;
  }
  return mesh;
}
