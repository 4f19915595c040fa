/** The same camera with clip depths of 0…1, reversed or not, as renderers for WebGPU make them. */
export function withHostDepth({ cameraFromMatrices }, camera, { compare }) {
  const { near, far, viewMatrix } = camera;
  const isReversed = compare === 'greater-equal';
  const p = Float64Array.from(camera.projectionMatrix);
  const range = 1 / (far - near);
  if (p[11] === 0) [p[10], p[14]] = isReversed ? [range, far * range] : [-range, -near * range];
  else [p[10], p[14]] = isReversed ? [near * range, far * near * range] : [-far * range, -far * near * range];
  return cameraFromMatrices(viewMatrix, p, { near, far });
}

/** Corners of a plane that leans into a cloud about the origin, and of one that stands behind its lower part; triangles. */
const MESHES = [
  {
    corners: [
      [-0.9, -0.7, 0.6],
      [0.5, -0.6, 0.9],
      [-0.7, 0.8, -0.6],
      [0.6, 0.7, -0.4],
    ],
    color: [0.9, 0.5, 0.1],
  },
  {
    corners: [
      [-0.2, -1.2, -0.3],
      [1.2, -1.2, -0.6],
      [-0.1, -0.1, -0.3],
      [1.2, -0.1, -0.6],
    ],
    color: [0.1, 0.7, 0.3],
  },
];
const SKY = [0.02, 0.04, 0.3, 1];
const CORNER_ORDER = [0, 1, 2, 2, 1, 3];

/**
 * Draws two planes as a host would, into textures somewhat larger than the viewport.
 *
 * @returns linear colours, resolved, and depths of all samples.
 */
export function drawHostMeshes(device, camera, { compare, mapping }, { widthPx, heightPx, samples, origin }) {
  const [xPx, yPx] = origin;
  const texture = (format, sampleCount, usage) =>
    device.createTexture({
      size: [widthPx + xPx + 3, heightPx + yPx + 2],
      format,
      sampleCount,
      usage: usage | GPUTextureUsage.RENDER_ATTACHMENT,
    });
  const color = texture('rgba16float', 1, GPUTextureUsage.TEXTURE_BINDING);
  const depth = texture('depth32float', samples, GPUTextureUsage.TEXTURE_BINDING);
  const sampled = samples > 1 ? texture('rgba16float', samples, 0) : null;
  const module = device.createShaderModule({ code: shader(camera, mapping) });
  const pipeline = device.createRenderPipeline({
    layout: 'auto',
    vertex: { module },
    fragment: { module, targets: [{ format: 'rgba16float' }] },
    multisample: { count: samples },
    depthStencil: { format: 'depth32float', depthCompare: compare, depthWriteEnabled: true },
  });
  const encoder = device.createCommandEncoder();
  const pass = encoder.beginRenderPass({
    colorAttachments: [
      {
        view: (sampled ?? color).createView(),
        ...(sampled && { resolveTarget: color.createView() }),
        loadOp: 'clear',
        storeOp: 'store',
        clearValue: SKY,
      },
    ],
    depthStencilAttachment: {
      view: depth.createView(),
      depthLoadOp: 'clear',
      depthStoreOp: 'store',
      depthClearValue: compare === 'less-equal' ? 1 : 0,
    },
  });
  pass.setViewport(xPx, yPx, widthPx, heightPx, 0, 1);
  pass.setPipeline(pipeline);
  pass.draw(MESHES.length * CORNER_ORDER.length);
  pass.end();
  device.queue.submit([encoder.finish()]);
  sampled?.destroy();
  return { color, depth };
}

function shader({ viewMatrix, projectionMatrix, near, far }, mapping) {
  const corners = MESHES.flatMap((mesh) => CORNER_ORDER.map((corner) => [...mesh.corners[corner], 1]));
  const views = corners.map((corner) => transform(viewMatrix, corner));
  const vectors = (points) =>
    points.map((point) => `vec4f(${point.map((value) => value.toFixed(9))})`).join(', ');
  const colors = MESHES.map((mesh) => `vec3f(${mesh.color})`).join(', ');
  const isOrthographic = projectionMatrix[11] === 0;
  const logarithmic = isOrthographic
    ? `(depthView - ${near}) / ${far - near}`
    : `log2(depthView / ${near}) / ${Math.log2(far / near)}`;
  return `
struct Corner {
  @builtin(position) position: vec4f,
  @location(0) depthView: f32,
  @location(1) color: vec3f,
}
@vertex fn corner(@builtin(vertex_index) i: u32) -> Corner {
  var positions = array(${vectors(views.map((view) => transform(projectionMatrix, view)))});
  var views = array(${vectors(views)});
  var colors = array(${colors});
  return Corner(positions[i], -views[i].z, colors[i / ${CORNER_ORDER.length}]);
}
struct Painted {
  @location(0) color: vec4f,
  @builtin(frag_depth) depth: f32,
}
@fragment fn paint(corner: Corner) -> Painted {
  let depthView = corner.depthView;
  return Painted(vec4f(corner.color, 1.0), ${mapping === 'logarithmic' ? logarithmic : 'corner.position.z'});
}`;
}

function transform(matrix, point) {
  return [0, 1, 2, 3].map((row) =>
    point.reduce((sum, value, column) => sum + matrix[4 * column + row] * value, 0),
  );
}
