import { InvalidArgumentError } from '@websplatter/core';
import type { ColliderMesh, ColliderMeshOptions } from '@websplatter/core/collider';
import type { SplatData } from '@websplatter/three';
import { useEffect, useState } from 'react';
import { isServer } from './is-server.ts';
import { useSame } from './stable-values.ts';
import { useCanvasRenderer } from './use-renderer.ts';
import { useSplatEngine } from './use-splat-engine.ts';

/** State of a collider. */
export interface SplatCollider {
  /** `none` without splats, and on a server. */
  readonly status: 'none' | 'pending' | 'made' | 'failed';
  /** Mesh in the cloud's own space; null until it is made. Empty if nothing is opaque. */
  readonly mesh: ColliderMesh | null;
  /** Error of `makeColliderMesh`; undefined unless it has failed. */
  readonly error: unknown;
}

/** Options of `useSplatCollider`. */
export type SplatColliderOptions = Pick<
  ColliderMeshOptions,
  'bounds' | 'cellSize' | 'fewestTriangles' | 'solidAt'
>;

const NONE: SplatCollider = { status: 'none', mesh: null, error: undefined };
const PENDING: SplatCollider = { ...NONE, status: 'pending' };

/**
 * Makes a coarse mesh around the opaque parts of splats, in a worker, for physics engines:
 * `<TrimeshCollider args={[mesh.positions, mesh.indices]} />` of @react-three/rapier. Options as for
 * `makeColliderMesh` of `@websplatter/core/collider`, whose code is fetched when the splats are
 * loaded. Other splats or options start anew. A new start and unmounting cancel work under way.
 *
 * @param splats result of `useSplats` or `onLoad`; null: no collider. A preview gives `failed`.
 * @throws InvalidArgumentError outside of a Canvas; SplatsUnsupportedRendererError in a Canvas
 *   whose renderer cannot draw splats.
 * @example
 * function Garden() {
 *   const splats = useSplats('/garden.ply');
 *   const { mesh } = useSplatCollider(splats, { cellSize: 0.1 });
 *   const collider = mesh && <TrimeshCollider args={[mesh.positions, mesh.indices]} />;
 *   return <RigidBody type="fixed" colliders={false}>{collider}<Splats src={splats} /></RigidBody>;
 * }
 */
export function useSplatCollider(
  splats: SplatData | null | undefined,
  options: SplatColliderOptions = {},
): SplatCollider {
  const renderer = useCanvasRenderer();
  const wanted = useSame(options);
  const [made, setMade] = useState<{ readonly of: readonly unknown[]; readonly collider: SplatCollider }>();
  if (!renderer && !isServer())
    throw new InvalidArgumentError('renderer', 'useSplatCollider needs a Canvas around it.');
  const engine = useSplatEngine(renderer);
  useEffect(() => {
    if (!splats || !engine) return;
    const abort = new AbortController();
    const user = {};
    const take = (collider: SplatCollider) => {
      if (!abort.signal.aborted) setMade({ of: [splats, engine, wanted], collider });
    };
    const make = async () => {
      const { makeColliderMesh } = await import('@websplatter/core/collider');
      abort.signal.throwIfAborted();
      const cloud = await splats.acquire(engine, user);
      return makeColliderMesh(cloud, { ...wanted, signal: abort.signal });
    };
    make()
      .then(
        (mesh) => take({ status: 'made', mesh, error: undefined }),
        (error: unknown) => take({ status: 'failed', mesh: null, error }),
      )
      .finally(() => splats.release(user));
    return () => abort.abort();
  }, [splats, engine, wanted]);
  if (!splats || !renderer) return NONE;
  const isOfThese = made?.of.every((part, i) => part === [splats, engine, wanted][i]);
  return isOfThese ? made!.collider : PENDING;
}
