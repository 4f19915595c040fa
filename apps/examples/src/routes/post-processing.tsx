import { OrbitControls } from '@react-three/drei';
import { useFrame, useThree } from '@react-three/fiber';
import { SplatCanvas, Splats } from '@websplatter/react';
import { Suspense, useEffect, useMemo, useState } from 'react';
import { bloom } from 'three/addons/tsl/display/BloomNode.js';
import { dof } from 'three/addons/tsl/display/DepthOfFieldNode.js';
import { traa } from 'three/addons/tsl/display/TRAANode.js';
import { mrt, output, pass, uniform, velocity } from 'three/tsl';
import { type Node, RenderPipeline, type WebGPURenderer } from 'three/webgpu';

export default function PostProcessing() {
  const [focus, setFocus] = useState(1.3);
  const [glow, setGlow] = useState(0.4);
  return (
    <>
      <SplatCanvas flat camera={{ position: [0.12, 0.45, 1.44], fov: 50, near: 0.05 }}>
        <Suspense>
          <Splats src="still-life.sog" depthWrite />
        </Suspense>
        <mesh position={[-0.26, 0.13, 0.2]}>
          <sphereGeometry args={[0.05]} />
          <meshBasicMaterial color={[4, 2.8, 1.4]} />
        </mesh>
        <Lens focus={focus} glow={glow} />
        <OrbitControls />
      </SplatCanvas>
      <form className="panel">
        <label>
          Focus
          <input
            type="range"
            min={0.8}
            max={2.2}
            step="any"
            value={focus}
            onChange={(event) => setFocus(event.target.valueAsNumber)}
          />
        </label>
        <label>
          Glow
          <input
            type="range"
            min={0}
            max={1}
            step="any"
            value={glow}
            onChange={(event) => setGlow(event.target.valueAsNumber)}
          />
        </label>
      </form>
    </>
  );
}

/** Renders the Canvas with TRAA, depth of field and bloom; splats and meshes are in one image. */
function Lens({ focus, glow }: { focus: number; glow: number }) {
  const { gl, scene, camera } = useThree();
  const lens = useMemo(() => {
    const [distance, strength] = [uniform(1), uniform(0)];
    // TRAA antialiases by itself, and copies depth from single-sample targets only.
    const scenePass = pass(scene, camera, { samples: 0 });
    scenePass.setMRT(mrt({ output, velocity }));
    const [color, depth, motion] = ['output', 'depth', 'velocity'].map((name) =>
      scenePass.getTextureNode(name),
    );
    const steady = traa(color, depth, motion, camera);
    // The node is a colour, although its type does not say so.
    const focused = dof(steady, scenePass.getViewZNode(), distance, 0.5, 3) as unknown as Node<'vec4'>;
    const image = focused.add(bloom(focused, strength, 0.3, 1));
    return { pipeline: new RenderPipeline(gl as unknown as WebGPURenderer, image), distance, strength };
  }, [gl, scene, camera]);
  useEffect(() => () => lens.pipeline.dispose(), [lens]);
  // A priority above 0 replaces the Canvas's own rendering.
  useFrame(() => {
    lens.distance.value = focus;
    lens.strength.value = glow;
    lens.pipeline.render();
  }, 1);
  return null;
}
