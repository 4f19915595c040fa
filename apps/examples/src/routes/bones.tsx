import { OrbitControls } from '@react-three/drei';
import { useFrame, useThree } from '@react-three/fiber';
import { SplatCanvas, type SplatCloudObject, Splats } from '@websplatter/react';
import { bindSkeleton, makeSplatData, weightsFromBones } from '@websplatter/react/own-data';
import { type RefObject, useCallback, useEffect, useRef, useState } from 'react';
import { Bone, CylinderGeometry, Mesh, MeshBasicMaterial, Skeleton, SphereGeometry } from 'three';

const prefersStillness = matchMedia('(prefers-reduced-motion: reduce)').matches;

const COUNT = 14_000;
const GOLDEN_RATIO = (1 + Math.sqrt(5)) / 2;
const HEIGHT = 1.7;
const BONES = 8;
/** Turn of each bone from the one below, radians, at the full bend. */
const BEND = 0.72;

/** An arm that tapers from the ground up, with rings around it, lit from the left. */
function arm() {
  const positions: number[] = [];
  const colors: number[] = [];
  const scales: number[] = [];
  for (let i = 0; i < COUNT; i++) {
    const t = 1 - Math.sqrt(1 - (0.998 * (i + 0.5)) / COUNT);
    const angle = 2 * Math.PI * ((i * GOLDEN_RATIO) % 1);
    const radius = 0.2 * (1 - t) + 0.015;
    const [x, z] = [Math.cos(angle), Math.sin(angle)];
    positions.push(radius * x, HEIGHT * t, radius * z);
    const isRing = (18 * t) % 1 < 0.35;
    const light = 0.62 + 0.38 * (0.7 * z - 0.7 * x);
    const color = isRing ? [0.98, 0.83, 0.62] : [0.86 - 0.3 * t, 0.3, 0.28 + 0.35 * t];
    colors.push(...color.map((value) => Math.min(1, light * value)));
    const size = 0.008 + 0.006 * (1 - t);
    scales.push(size, size, size);
  }
  return { positions, colors, scales };
}

/** A chain of bones within the arm, and their weights. */
function rig() {
  const arrays = arm();
  const bones = Array.from({ length: BONES }, () => new Bone());
  for (const [i, bone] of bones.entries()) {
    if (i > 0) bone.position.y = HEIGHT / BONES;
    bones[i - 1]?.add(bone);
  }
  bones[0].updateMatrixWorld(true);
  // Drawn after the splats and over all.
  const material = new MeshBasicMaterial({ color: '#1769ff', transparent: true, depthTest: false });
  for (const [i, bone] of bones.entries()) {
    const ball = new Mesh(new SphereGeometry(0.034 - 0.002 * i), material);
    const rod = new Mesh(new CylinderGeometry(0.004, 0.014, HEIGHT / BONES), material);
    rod.position.y = HEIGHT / BONES / 2;
    ball.renderOrder = rod.renderOrder = 1;
    bone.add(ball, rod);
  }
  const weights = weightsFromBones(arrays, bones, { falloff: 3 });
  return { data: makeSplatData(arrays), skeleton: new Skeleton(bones), weights };
}

export default function Bones() {
  const [{ data, skeleton, weights }] = useState(rig);
  const slider = useRef<HTMLInputElement>(null);
  const [isMoving, setMoving] = useState(!prefersStillness);
  const [bend, setBend] = useState(0);
  const bind = useCallback(
    (cloud: SplatCloudObject | null) => {
      if (cloud) bindSkeleton(cloud, skeleton, weights);
    },
    [skeleton, weights],
  );
  return (
    <>
      <SplatCanvas
        flat
        frameloop={isMoving ? 'always' : 'demand'}
        camera={{ position: [0.3, 0.3, 2], fov: 50, near: 0.05 }}
      >
        <group position={[-0.2, -0.75, 0]}>
          <Splats ref={bind} src={data} />
          <primitive object={skeleton.bones[0]} />
        </group>
        {isMoving ? (
          <Waving bones={skeleton.bones} slider={slider} />
        ) : (
          <Bent bones={skeleton.bones} bend={bend} />
        )}
        <OrbitControls />
      </SplatCanvas>
      <form className="panel">
        <label>
          Bend
          <input
            ref={slider}
            type="range"
            min={-1}
            max={1}
            step="any"
            defaultValue={0}
            onInput={(event) => {
              setMoving(false);
              setBend(event.currentTarget.valueAsNumber);
            }}
          />
        </label>
        <label>
          <input type="checkbox" checked={isMoving} onChange={() => setMoving(!isMoving)} /> Moving
        </label>
      </form>
    </>
  );
}

function turn(bones: readonly Bone[], bend: number, phase = 0) {
  for (const [i, bone] of bones.entries())
    bone.rotation.z = i === 0 ? 0 : -BEND * bend * (0.55 + 0.45 * Math.cos(0.55 * i + phase));
}

function Bent({ bones, bend }: { bones: readonly Bone[]; bend: number }) {
  const invalidate = useThree((state) => state.invalidate);
  useEffect(() => {
    turn(bones, bend);
    // Bones request no frames.
    invalidate();
  }, [bones, bend, invalidate]);
  return null;
}

function Waving({ bones, slider }: { bones: readonly Bone[]; slider: RefObject<HTMLInputElement | null> }) {
  const timeS = useRef(0);
  useFrame((_state, elapsedS) => {
    timeS.current += Math.min(elapsedS, 0.1);
    const bend = Math.sin(timeS.current);
    turn(bones, bend, 0.7 * Math.sin(0.6 * timeS.current));
    slider.current!.value = String(bend);
  });
  return null;
}
