import { orthographicCamera, perspectiveCamera } from '@websplatter/core';
import { verticalFov } from '@websplatter/kit/vertical-fov';
import { describe, expect, it } from 'vitest';
import { lookAt } from '../state/orbit-pose.ts';
import { orbitNear } from './orbit-near.ts';

const UNIT = { center: [0, 0, 0], radius: 1 } as const;

describe('orbit near a camera', () => {
  const view = { position: [3, 1, 4], target: [0, 0, 0], near: 0.1, far: 100 } as const;

  it.each([0.5, 1.6])('is that of a perspective camera at aspect %d', (aspect) => {
    const camera = perspectiveCamera({ ...view, fovYDegrees: 40, aspect });
    const { pose, fovDegrees } = orbitNear(camera, UNIT, aspect);
    expect(verticalFov(fovDegrees, aspect)).toBeCloseTo(40);
    const again = perspectiveCamera({ ...lookAt(pose), fovYDegrees: 40, aspect });
    for (let i = 0; i < 16; i++) expect(again.viewMatrix[i]).toBeCloseTo(camera.viewMatrix[i]);
  });

  it('shows as much as an orthographic camera does at the middle of the scene', () => {
    const camera = orthographicCamera({ ...view, height: 6, aspect: 1.5 });
    const { pose, fovDegrees } = orbitNear(camera, UNIT, 1.5);
    expect(2 * pose.distance * Math.tan((fovDegrees * Math.PI) / 360)).toBeCloseTo(6);
    const { position } = lookAt(pose);
    expect(position[0] / position[2]).toBeCloseTo(3 / 4);
  });

  it('keeps the roll of a camera', () => {
    const camera = perspectiveCamera({ ...view, up: [1, 0, 0], fovYDegrees: 40, aspect: 1 });
    const { pose } = orbitNear(camera, UNIT, 1);
    const again = perspectiveCamera({ ...lookAt(pose), fovYDegrees: 40, aspect: 1 });
    for (let i = 0; i < 16; i++) expect(again.viewMatrix[i]).toBeCloseTo(camera.viewMatrix[i]);
  });

  it('turns to a scene that is behind', () => {
    const camera = perspectiveCamera({ ...view, target: [6, 2, 8], fovYDegrees: 40, aspect: 1 });
    expect(orbitNear(camera, UNIT, 1).pose.target).toEqual([0, 0, 0]);
  });
});
