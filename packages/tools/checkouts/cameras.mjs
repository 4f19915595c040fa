/** Cameras that look at a cloud of half extent 1 about the origin, some of it out of sight. */
export function testCameras({ perspectiveCamera, orthographicCamera, cameraFromMatrices }, aspect) {
  const place = { position: [1.1, 0.6, 1.4], target: [0.1, -0.1, 0], up: [0.1, 1, 0.05], aspect };
  const range = { near: 0.1, far: 100 };
  const perspective = perspectiveCamera({ ...place, ...range, fovYDegrees: 50 });
  const offCentre = Float64Array.from(perspective.projectionMatrix);
  [offCentre[8], offCentre[9]] = [0.4, -0.3];
  const mirrored = Float64Array.from(perspective.projectionMatrix, (value, i) =>
    i % 4 === 0 ? -value : value,
  );
  const inside = { ...place, position: [0.1, 0.05, 0.2], target: [0, 0.3, -1] };
  return {
    perspective,
    inside: perspectiveCamera({ ...inside, ...range, fovYDegrees: 100 }),
    orthographic: orthographicCamera({ ...place, ...range, height: 1.5 }),
    'off-centre': cameraFromMatrices(perspective.viewMatrix, offCentre, range),
    mirrored: cameraFromMatrices(perspective.viewMatrix, mirrored, range),
  };
}

/** The perspective camera elsewhere: moved to a side, or turned in its place. */
export function cameraAt({ perspectiveCamera }, aspect, { moved = 0, turned = 0 } = {}) {
  return perspectiveCamera({
    position: [1.1 + moved, 0.6, 1.4],
    target: [0.1 + turned, -0.1 + 0.3 * turned, 0],
    fovYDegrees: 50,
    aspect,
    near: 0.1,
    far: 100,
  });
}

export const MODELS = {
  sheared: [1, 0.3, 0, 0, 0.5, 1, -0.2, 0, 0, 0.4, 0.8, 0, 0, 0, 0.1, 1],
  mirrored: [0.9, 0, 0.2, 0, 0, -0.8, 0, 0, -0.2, 0, 1.1, 0, 0.3, 0.1, 0, 1],
};
