import { BallCollider, Physics, RigidBody, TrimeshCollider } from '@react-three/rapier';
import { SplatCanvas, Splats, useSplats } from '@websplatter/react';
import { useSplatCollider } from '@websplatter/react/hooks';
import { Suspense, useEffect, useMemo, useState } from 'react';
import { BufferAttribute, BufferGeometry } from 'three';

const RADIUS = 0.03;
/** The table and the objects on it. */
const BOUNDS = { min: [-0.7, -0.1, -0.7], max: [0.7, 0.4, 0.7] } as const;

/** Splats with a collision mesh, in one rigid body, and balls that bounce off it. */
function Scene({ isMeshShown, onMade }: { isMeshShown: boolean; onMade: (triangles: number) => void }) {
  const splats = useSplats('still-life.sog');
  const { mesh } = useSplatCollider(splats, { bounds: BOUNDS, cellSize: 0.02 });
  const geometry = useMemo(() => {
    if (!mesh) return null;
    const made = new BufferGeometry();
    made.setAttribute('position', new BufferAttribute(mesh.positions, 3));
    return made.setIndex(new BufferAttribute(mesh.indices, 1));
  }, [mesh]);
  useEffect(() => {
    if (mesh) onMade(mesh.indices.length / 3);
  }, [mesh, onMade]);
  return (
    <RigidBody type="fixed" colliders={false}>
      <Splats src={splats} />
      {mesh && <TrimeshCollider args={[mesh.positions, mesh.indices]} friction={1} />}
      {geometry && isMeshShown && (
        <mesh geometry={geometry}>
          <meshBasicMaterial color="#ff2d87" wireframe />
        </mesh>
      )}
    </RigidBody>
  );
}

export default function Colliders() {
  const [balls, setBalls] = useState<readonly number[]>([]);
  const [isMeshShown, setIsMeshShown] = useState(false);
  const [triangles, setTriangles] = useState<number | null>(null);
  // The golden angle: no ball falls where the previous one did.
  const drop = () => setBalls((others) => [...others, 2.4 * others.length]);
  return (
    <>
      <SplatCanvas flat camera={{ position: [0.12, 0.55, 1.44], fov: 50, near: 0.05 }}>
        <ambientLight intensity={1.2} />
        <directionalLight position={[1, 3, 2]} intensity={2} />
        <Suspense>
          <Physics>
            <Scene isMeshShown={isMeshShown} onMade={setTriangles} />
            {balls.map((angle) => (
              <RigidBody
                key={angle}
                colliders={false}
                position={[0.3 * Math.cos(angle), 0.6, 0.25 + 0.15 * Math.sin(angle)]}
                angularDamping={4}
                // The mesh is hollow: a fast ball could pass through it between two steps.
                ccd
              >
                <BallCollider args={[RADIUS]} friction={1} restitution={0.4} />
                <mesh>
                  <sphereGeometry args={[RADIUS]} />
                  <meshStandardMaterial color="#ffb347" roughness={0.4} />
                </mesh>
              </RigidBody>
            ))}
          </Physics>
        </Suspense>
      </SplatCanvas>
      <form className="panel" onSubmit={(event) => event.preventDefault()}>
        <button type="button" onClick={drop} disabled={triangles === null}>
          Drop a ball
        </button>
        <label>
          <input
            type="checkbox"
            checked={isMeshShown}
            onChange={(event) => setIsMeshShown(event.target.checked)}
          />
          Show the mesh
        </label>
        <output>
          {triangles === null ? 'Making a mesh…' : `${triangles.toLocaleString('en')} triangles`}
        </output>
      </form>
    </>
  );
}
