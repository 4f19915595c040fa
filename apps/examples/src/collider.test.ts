import { existsSync } from 'node:fs';
import { readFile } from 'node:fs/promises';
import type { World } from '@dimforge/rapier3d-compat';
import { loadSplats } from '@websplatter/core';
import { makeColliderMesh } from '@websplatter/core/collider';
import { builtinScenes } from '@websplatter/scenes';
import { beforeAll, describe, expect, it, vi } from 'vitest';

const CELL_SIZE = 0.025;
const RADIUS = 0.04;

/** The engine is installed with the examples, which `npm run test:full` does. */
const isInstalled = existsSync(new URL('../node_modules/@dimforge/rapier3d-compat', import.meta.url));

describe.runIf(isInstalled || process.env.WEBSPLATTER_FULL === '1')(
  'the mesh of a cloud, in a physics engine',
  { tags: 'deeper' },
  () => {
    let RAPIER: typeof import('@dimforge/rapier3d-compat').default;
    let world: World;

    beforeAll(async () => {
      ({ default: RAPIER } = await import('@dimforge/rapier3d-compat'));
      // Rapier's own package calls its WebAssembly in a way that is deprecated, and says so.
      const warn = vi.spyOn(console, 'warn').mockImplementation(() => {});
      await RAPIER.init();
      warn.mockRestore();
      const splats = await loadSplats(new Blob([await readFile(builtinScenes[0].url)]));
      // The table, whose top is at y = 0, and the things on it.
      const bounds = { min: [-0.7, -0.1, -0.7], max: [0.7, 0.4, 0.7] } as const;
      const { positions, indices } = await makeColliderMesh(splats, { cellSize: CELL_SIZE, bounds });
      world = new RAPIER.World({ x: 0, y: -9.81, z: 0 });
      world.createCollider(RAPIER.ColliderDesc.trimesh(positions, indices));
    });

    /**
     * Drops a ball, in steps too short to pass the hollow mesh; returns its place and speed after
     * some seconds.
     */
    function dropped(x: number, y: number, z: number) {
      const description = RAPIER.RigidBodyDesc.dynamic()
        .setTranslation(x, y, z)
        .setAngularDamping(8)
        .setCcdEnabled(true);
      const body = world.createRigidBody(description);
      world.createCollider(RAPIER.ColliderDesc.ball(RADIUS).setRestitution(0.1).setFriction(1), body);
      for (let step = 0; step < 600; step++) world.step();
      const { x: vx, y: vy, z: vz } = body.linvel();
      const place = body.translation();
      world.removeRigidBody(body);
      return { ...place, speed: Math.hypot(vx, vy, vz) };
    }

    it.each([
      [-0.05, 0.3],
      [-0.2, 0.42],
      [0.1, 0.4],
    ])('a ball that falls on the table at %s, %s rests on it, within a cell of what is seen', (x, z) => {
      const rest = dropped(x, 0.3, z);
      expect(rest.speed).toBeLessThan(0.02);
      expect(Math.hypot(rest.x - x, rest.z - z)).toBeLessThan(0.2);
      expect(rest.y - RADIUS).toBeGreaterThan(-0.005);
      expect(rest.y - RADIUS).toBeLessThan(CELL_SIZE + 0.005);
    });

    it('a ball beside the table falls', () => {
      expect(dropped(0.9, 0.3, 0.9).y).toBeLessThan(-5);
    });
  },
);
