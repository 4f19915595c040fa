// What is tried of drei beside splats under three's WebGPURenderer, and what stands in where drei's own does not work.
import {
  AccumulativeShadows,
  AdaptiveDpr,
  AdaptiveEvents,
  ArcballControls,
  BakeShadows,
  Billboard,
  Bounds,
  Bvh,
  CameraControls,
  CameraShake,
  Caustics,
  Center,
  ContactShadows,
  CubeCamera,
  CycleRaycast,
  Decal,
  Detailed,
  DragControls,
  Edges,
  Environment,
  Float,
  FlyControls,
  GizmoHelper,
  GizmoViewcube,
  GizmoViewport,
  GradientTexture,
  Grid,
  Html,
  Hud,
  Image,
  Instance,
  Instances,
  KeyboardControls,
  Lightformer,
  Line,
  Loader,
  MapControls,
  Mask,
  MeshPortalMaterial,
  MeshReflectorMaterial,
  MeshRefractionMaterial,
  MeshTransmissionMaterial,
  OrbitControls,
  OrthographicCamera,
  Outlines,
  PerformanceMonitor,
  PerspectiveCamera,
  PivotControls,
  Point,
  Points,
  Preload,
  PresentationControls,
  RandomizedLight,
  RenderTexture,
  Resize,
  RoundedBox,
  Scroll,
  ScrollControls,
  Segment,
  Segments,
  Select,
  Shadow,
  Sky,
  SoftShadows,
  Sparkles,
  SpotLight,
  Stage,
  Stars,
  Stats,
  Svg,
  Text,
  Text3D,
  TrackballControls,
  Trail,
  TransformControls,
  useFBO,
  useGLTF,
  useHelper,
  useKeyboardControls,
  useMask,
  useProgress,
  useTexture,
  View,
  Wireframe,
} from '@react-three/drei';
import { type RootState, useFrame } from '@react-three/fiber';
import { type SplatCanvas, type SplatCloudObject, Splats } from '@websplatter/react';
import { type ComponentProps, type ComponentType, type ReactNode, useMemo, useRef, useState } from 'react';
import { BackSide, BoxGeometry, BoxHelper, type Mesh } from 'three';
import { LineGeometry } from 'three/addons/lines/LineGeometry.js';
import { Line2 } from 'three/addons/lines/webgpu/Line2.js';
import { GroundedSkybox } from 'three/addons/objects/GroundedSkybox.js';
import { SkyMesh } from 'three/addons/objects/SkyMesh.js';
import { instancedBufferAttribute, reflector } from 'three/tsl';
import {
  InstancedBufferAttribute,
  Line2NodeMaterial,
  MeshBasicNodeMaterial,
  PointsNodeMaterial,
  Sprite,
} from 'three/webgpu';

/** Something that stands on the right of a Canvas of 240 × 160 pixels, whose left shows a red ball of splats. */
export interface Trial {
  readonly element: ComponentType<SceneProps>;
  /** Stands around the Canvas. */
  readonly around?: ComponentType<{ children: ReactNode }>;
  readonly canvas?: Partial<ComponentProps<typeof SplatCanvas>>;
  /**
   * What is to happen: pixels change; the camera, or the object named `target`, moves when the mouse is dragged across the
   * middle of the right half, where W is held; or what `holds` says becomes so. Default: pixels.
   */
  readonly expects?: 'pixels' | 'camera' | 'target' | 'holds';
  readonly holds?: (state: RootState) => boolean;
  /** Colours that are to be seen: column, row, and sRGB of 0…255. */
  readonly colors?: readonly (readonly [
    xPx: number,
    yPx: number,
    color: readonly [number, number, number],
  ])[];
  /** Whether it covers the splats, or moves them: they are not looked for then. */
  readonly coversSplats?: boolean;
  /** The component in whose place it stands. */
  readonly insteadOf?: readonly string[];
}

export interface SceneProps {
  readonly splats: React.RefObject<SplatCloudObject | null>;
}

const RIGHT = [1.5, 0, 0] as const;
/** As far as rays through the red ball are from its middle when they are twice as far away as that from the camera. */
const BEHIND = [-3, 0, -5] as const;
const BEFORE = [-0.75, 0, 2.5] as const;
/** A plus sign in the font of the page. */
const PLUS = '\uea60';
const WHITE = [255, 255, 255] as const;
const BACKGROUND = [32, 32, 32] as const;

function Box({ children, ...props }: ComponentProps<'mesh'>): ReactNode {
  return (
    <mesh position={RIGHT} {...props}>
      <boxGeometry />
      {children ?? <meshStandardMaterial color="#40c060" />}
    </mesh>
  );
}

/** A box that cannot be told from the background. */
function DarkBox({ children, ...props }: ComponentProps<'mesh'>): ReactNode {
  return (
    <Box {...props}>
      <meshBasicMaterial color="#202020" />
      {children}
    </Box>
  );
}

function Floor({ children }: { children: ReactNode }): ReactNode {
  return (
    <mesh rotation-x={-Math.PI / 2} position={[1.5, -1, 0]} receiveShadow>
      <planeGeometry args={[3, 3]} />
      {children}
    </mesh>
  );
}

function Label({ id }: { id?: string }): ReactNode {
  return (
    <b id={id} className="label">
      Label
    </b>
  );
}

const isShown = (id: string) => document.getElementById(id)?.checkVisibility() === true;

const shows = (element: ComponentType<SceneProps>, more: Partial<Trial> = {}): Trial => ({
  element,
  ...more,
});
const controls = (element: ComponentType<SceneProps>): Trial => ({
  element,
  expects: 'camera',
  coversSplats: true,
});
const moves = (element: ComponentType<SceneProps>): Trial => ({ element, expects: 'target' });
const instead = (
  insteadOf: readonly string[],
  element: ComponentType<SceneProps>,
  more: Partial<Trial> = {},
): Trial => ({ element, insteadOf, ...more });

/** By the name that packages/react/README.md has for it. */
export const TRIALS: Readonly<Record<string, Trial>> = {
  OrbitControls: controls(() => <OrbitControls />),
  MapControls: controls(() => <MapControls />),
  CameraControls: controls(() => <CameraControls />),
  TrackballControls: controls(() => <TrackballControls />),
  ArcballControls: controls(() => <ArcballControls />),
  FlyControls: controls(() => <FlyControls dragToLook rollSpeed={1} />),
  CameraShake: controls(() => <CameraShake />),
  Bounds: shows(
    () => (
      <Bounds fit observe margin={1}>
        <Box />
      </Bounds>
    ),
    { expects: 'holds', holds: ({ camera }) => camera.position.z < 4, coversSplats: true },
  ),
  PresentationControls: moves(() => (
    <PresentationControls global>
      <Box name="target" />
    </PresentationControls>
  )),
  TransformControls: moves(() => (
    <TransformControls mode="translate" size={2} position={RIGHT}>
      <Box name="target" position={[0, 0, 0]} />
    </TransformControls>
  )),
  PivotControls: moves(() => (
    <group position={RIGHT}>
      <PivotControls depthTest={false} scale={1.5} lineWidth={6}>
        <Box name="target" position={[0, 0, 0]} />
      </PivotControls>
    </group>
  )),
  DragControls: moves(() => (
    <DragControls>
      <Box name="target" />
    </DragControls>
  )),
  ScrollControls: shows(() => (
    <ScrollControls pages={3}>
      <Scroll>
        <Box />
      </Scroll>
    </ScrollControls>
  )),
  KeyboardControls: shows(
    () => {
      const keys = useKeyboardControls()[1];
      useFrame(({ scene }) => {
        scene.userData.isForward ||= keys().forward;
      });
      return null;
    },
    {
      around: ({ children }) => (
        <KeyboardControls map={[{ name: 'forward', keys: ['w'] }]}>{children}</KeyboardControls>
      ),
      expects: 'holds',
      holds: ({ scene }) => scene.userData.isForward,
    },
  ),
  Select: shows(
    () => {
      const [selected, select] = useState(0);
      return (
        <group name="selection" userData={{ selected }}>
          <Select onChangePointerUp={(objects) => select(objects.length)}>
            <Box />
          </Select>
        </group>
      );
    },
    { expects: 'holds', holds: ({ scene }) => scene.getObjectByName('selection')?.userData.selected === 1 },
  ),
  GizmoHelper: shows(() => (
    <GizmoHelper alignment="bottom-right" margin={[50, 50]}>
      <axesHelper args={[40]} />
    </GizmoHelper>
  )),
  GizmoViewport: shows(() => (
    <GizmoHelper alignment="bottom-right" margin={[50, 50]}>
      <GizmoViewport />
    </GizmoHelper>
  )),
  GizmoViewcube: shows(() => (
    <GizmoHelper alignment="bottom-right" margin={[50, 50]}>
      <GizmoViewcube />
    </GizmoHelper>
  )),

  Html: shows(() => (
    <Html position={RIGHT}>
      <Label />
    </Html>
  )),
  'Html transform': shows(() => (
    <Html position={RIGHT} transform>
      <Label />
    </Html>
  )),
  'Html occlude': shows(
    ({ splats }) => (
      <>
        {/* Without `eps`, drei looks again only when the camera moves. */}
        <Html position={BEHIND} occlude={[splats as React.RefObject<SplatCloudObject>]} eps={-1}>
          <Label id="behind" />
        </Html>
        <Html position={BEFORE} occlude={[splats as React.RefObject<SplatCloudObject>]} eps={-1}>
          <Label id="before" />
        </Html>
      </>
    ),
    { expects: 'holds', holds: () => isShown('before') && !isShown('behind') },
  ),
  'Html occlude="blending"': shows(() => (
    <Html position={RIGHT} occlude="blending">
      <Label />
    </Html>
  )),
  Text: shows(
    () => (
      <Text
        position={RIGHT}
        font="font.ttf"
        characters={PLUS}
        fontSize={1.6}
        anchorX="center"
        anchorY="middle"
      >
        {PLUS}
      </Text>
    ),
    { colors: [[180, 54, BACKGROUND]] },
  ),
  Text3D: shows(() => (
    <Text3D position={RIGHT} font="typeface.json">
      A
      <meshBasicMaterial />
    </Text3D>
  )),
  Billboard: shows(() => (
    <Billboard position={RIGHT}>
      <mesh>
        <planeGeometry />
      </mesh>
    </Billboard>
  )),
  Svg: shows(() => <Svg src="square.svg" position={[1.5, 0.5, 0]} scale={0.01} />),

  Line: shows(() => (
    <Line
      points={[
        [1, -1, 0],
        [2, 1, 0],
      ]}
      lineWidth={4}
    />
  )),
  'Line2 of three/addons/lines/webgpu/Line2.js': instead(['Line', 'Segments', 'Edges', 'Trail'], () => {
    const line = useMemo(() => {
      const geometry = new LineGeometry().setPositions([1, -1, 0, 2, 1, 0]);
      return new Line2(geometry, new Line2NodeMaterial({ color: 'white', linewidth: 4 }));
    }, []);
    return <primitive object={line} />;
  }),
  Segments: shows(() => (
    <Segments lineWidth={4}>
      <Segment start={[1, -1, 0]} end={[2, 1, 0]} color="white" />
    </Segments>
  )),
  Edges: shows(() => (
    <DarkBox>
      <Edges color="white" lineWidth={3} />
    </DarkBox>
  )),
  '<lineSegments>': instead(['Line', 'Segments', 'Edges'], () => {
    const box = useMemo(() => new BoxGeometry(), []);
    return (
      <lineSegments position={RIGHT}>
        <edgesGeometry args={[box]} />
        <lineBasicMaterial />
      </lineSegments>
    );
  }),
  Outlines: shows(() => (
    <DarkBox>
      <Outlines color="white" thickness={0.1} />
    </DarkBox>
  )),
  'side={BackSide}': instead(['Outlines'], () => (
    <>
      <DarkBox />
      <Box scale={1.2}>
        <meshBasicMaterial side={BackSide} />
      </Box>
    </>
  )),
  Wireframe: shows(() => (
    <DarkBox>
      <Wireframe />
    </DarkBox>
  )),
  '<meshBasicMaterial wireframe>': instead(['Wireframe'], () => (
    <Box>
      <meshBasicMaterial wireframe />
    </Box>
  )),
  Trail: shows(() => {
    const mesh = useRef<Mesh>(null);
    useFrame(({ clock: { elapsedTime } }) =>
      mesh.current?.position.set(1.5 + Math.sin(5 * elapsedTime), Math.cos(5 * elapsedTime), 0),
    );
    return (
      <Trail width={8} length={8} color="white">
        <mesh ref={mesh} visible={false}>
          <boxGeometry />
        </mesh>
      </Trail>
    );
  }),
  useHelper: shows(() => {
    const mesh = useRef<Mesh>(null!);
    useHelper(mesh, BoxHelper, 'white');
    return <DarkBox ref={mesh} />;
  }),
  Grid: shows(() => <Grid position-y={-1} args={[10, 10]} cellColor="white" sectionColor="white" />),
  '<gridHelper>': instead(['Grid'], () => <gridHelper position={[0, -1, 0]} />),

  Environment: shows(() => <Environment files="sky.hdr" background />),
  'Environment with children': shows(() => (
    <Environment background resolution={16}>
      <Lightformer scale={20} position={[2, 0, -5]} intensity={4} />
    </Environment>
  )),
  'Environment ground': shows(() => (
    <Environment files="sky.hdr" ground={{ height: 5, radius: 40, scale: 20 }} />
  )),
  'GroundedSkybox of three/addons/objects/GroundedSkybox.js': instead(['Environment ground'], () => {
    const map = useTexture('green.png');
    const sky = useMemo(() => new GroundedSkybox(map, 5, 40), [map]);
    return <primitive object={sky} position-y={4} />;
  }),
  Sky: shows(() => <Sky distance={50} sunPosition={[1, 1, -1]} />),
  'SkyMesh of three/addons/objects/SkyMesh.js': instead(
    ['Sky'],
    () => {
      const sky = useMemo(() => {
        const mesh = new SkyMesh();
        mesh.scale.setScalar(50);
        mesh.sunPosition.value.set(1, 1, -1);
        return mesh;
      }, []);
      return <primitive object={sky} />;
    },
    { coversSplats: true },
  ),
  Stars: shows(() => <Stars radius={20} depth={10} count={2000} factor={8} fade={false} />),
  Sparkles: shows(() => <Sparkles position={RIGHT} count={60} size={20} scale={2} />),
  'Points of a size': shows(
    () => (
      <Points position={RIGHT}>
        <pointsMaterial size={1} />
        <Point position={[0, 0, 0]} />
      </Points>
    ),
    { colors: [[171, 80, WHITE]] },
  ),
  Points: shows(() => (
    <Points position={RIGHT}>
      <pointsMaterial />
      {Array.from({ length: 100 }, (_, i) => (
        <Point key={String(i)} position={[(i % 10) / 5 - 1, Math.floor(i / 10) / 5 - 1, 0]} />
      ))}
    </Points>
  )),
  'a Sprite with PointsNodeMaterial': instead(['Stars', 'Sparkles', 'Points of a size'], () => {
    const points = useMemo(() => {
      const positions = Float32Array.from(
        { length: 60 },
        (_, i) => (i % 3 === 0 ? 1.5 : 0) + Math.sin(12.9898 * i),
      );
      const material = new PointsNodeMaterial({ size: 4, sizeAttenuation: false });
      material.positionNode = instancedBufferAttribute(new InstancedBufferAttribute(positions, 3));
      const sprite = new Sprite(material as never);
      sprite.count = 20;
      sprite.frustumCulled = false;
      return sprite;
    }, []);
    return <primitive object={points} />;
  }),

  ContactShadows: shows(() => (
    <>
      <DarkBox />
      <ContactShadows position={[1.5, -0.95, 0]} opacity={1} blur={1} far={3} scale={4} />
    </>
  )),
  AccumulativeShadows: shows(() => (
    <>
      <DarkBox castShadow />
      <AccumulativeShadows position-y={-1} frames={10} scale={10} color="white">
        <RandomizedLight position={[2, 4, 1]} />
      </AccumulativeShadows>
    </>
  )),
  SoftShadows: shows(() => (
    <>
      <SoftShadows />
      <Box castShadow />
    </>
  )),
  'shadows="variance"': instead(
    ['SoftShadows'],
    () => (
      <>
        <Box castShadow />
        <Floor>
          <meshStandardMaterial />
        </Floor>
      </>
    ),
    { canvas: { shadows: 'variance' } },
  ),
  '<shadowMaterial>': instead(['ContactShadows', 'AccumulativeShadows'], () => (
    <>
      <DarkBox castShadow />
      <Floor>
        <shadowMaterial color="white" opacity={1} />
      </Floor>
    </>
  )),
  Shadow: shows(() => <Shadow position={RIGHT} color="white" opacity={1} rotation-x={0} />),
  BakeShadows: shows(() => (
    <>
      <Box castShadow />
      <BakeShadows />
    </>
  )),
  Caustics: shows(() => (
    <Caustics position={[1.5, -1, 0]} color="white" ior={1.1} causticsOnly={false} backside={false}>
      <DarkBox position={[0, 1, 0]} />
    </Caustics>
  )),
  SpotLight: shows(() => (
    <SpotLight position={[1.5, 2, 0]} angle={0.5} attenuation={6} anglePower={2} color="white" />
  )),
  '<spotLight>': instead(['SpotLight'], () => (
    <>
      <spotLight position={[1.5, 2, 2]} intensity={50} />
      <Box />
    </>
  )),

  MeshTransmissionMaterial: shows(() => (
    <Box>
      <MeshTransmissionMaterial samples={2} resolution={64} />
    </Box>
  )),
  '<meshPhysicalMaterial transmission={1}>': instead(
    ['MeshTransmissionMaterial', 'MeshRefractionMaterial'],
    () => (
      <>
        <Box position={BEFORE} scale={[1, 1, 0.1]}>
          <meshPhysicalMaterial transmission={1} roughness={0} />
        </Box>
        <Box />
      </>
    ),
  ),
  MeshRefractionMaterial: shows(() => {
    const map = useTexture('green.png');
    return (
      <Box>
        <MeshRefractionMaterial envMap={map} />
      </Box>
    );
  }),
  MeshReflectorMaterial: shows(() => (
    <Box>
      <MeshReflectorMaterial mirror={1} resolution={64} color="#ffffff" />
    </Box>
  )),
  'reflector of three/tsl': instead(['MeshReflectorMaterial'], () => {
    const [mirror, material] = useMemo(() => {
      const reflection = reflector();
      return [reflection, new MeshBasicNodeMaterial({ colorNode: reflection })];
    }, []);
    // Upright, seen at an angle such that it shows the ball.
    return (
      <group position={[1.5, 0, -1]} rotation-y={-0.5}>
        <primitive object={mirror.target} />
        <mesh material={material}>
          <planeGeometry args={[3, 3]} />
        </mesh>
      </group>
    );
  }),
  MeshPortalMaterial: shows(
    () => (
      <Box>
        <MeshPortalMaterial resolution={64} blur={0}>
          <color attach="background" args={['#ffffff']} />
        </MeshPortalMaterial>
      </Box>
    ),
    { colors: [[171, 80, WHITE]] },
  ),
  Mask: shows(
    () => {
      const stencil = useMask(1);
      return (
        <>
          <Mask id={1} position={RIGHT}>
            <planeGeometry args={[0.5, 0.5]} />
          </Mask>
          <Box position={[1.5, 0, -1]}>
            <meshBasicMaterial {...stencil} />
          </Box>
        </>
      );
    },
    {
      canvas: { gl: { stencil: true } },
      colors: [
        [164, 80, WHITE],
        [164, 92, BACKGROUND],
      ],
    },
  ),
  Image: shows(() => <Image url="green.png" position={[1.5, 0, 0]} />),
  '<meshBasicMaterial map>': instead(['Image'], () => (
    <Box>
      <meshBasicMaterial map={useTexture('green.png')} />
    </Box>
  )),
  GradientTexture: shows(() => (
    <Box>
      <meshBasicMaterial>
        <GradientTexture stops={[0, 1]} colors={['white', 'green']} />
      </meshBasicMaterial>
    </Box>
  )),
  Decal: shows(() => {
    const map = useTexture('green.png');
    return (
      <DarkBox>
        <Decal position={[0, 0, 0.5]} scale={0.9} map={map} />
      </DarkBox>
    );
  }),
  RenderTexture: shows(
    () => (
      <mesh position={RIGHT}>
        <planeGeometry args={[2, 2]} />
        <meshBasicMaterial>
          <RenderTexture attach="map" width={64} height={64}>
            <color attach="background" args={['#ffffff']} />
            <Splats src="ball.ply" />
          </RenderTexture>
        </meshBasicMaterial>
      </mesh>
    ),
    {
      colors: [
        [171, 80, [253, 0, 0]],
        [145, 55, WHITE],
      ],
    },
  ),
  useFBO: shows(
    () => {
      const texture = useFBO(64, 64);
      const plane = useRef<Mesh>(null);
      useFrame(({ gl, scene, camera }) => {
        if (!plane.current) return;
        plane.current.visible = false;
        gl.setRenderTarget(texture);
        gl.render(scene, camera);
        gl.setRenderTarget(null);
        plane.current.visible = true;
      });
      return (
        <mesh ref={plane} position={[1.2, 0, 0]}>
          <planeGeometry args={[3, 2]} />
          <meshBasicMaterial map={texture.texture} />
        </mesh>
      );
    },
    { colors: [[140, 80, [230, 0, 0]]] },
  ),
  CubeCamera: shows(() => (
    <CubeCamera position={RIGHT} resolution={32}>
      {(texture) => (
        <mesh>
          <sphereGeometry />
          <meshBasicMaterial envMap={texture} />
        </mesh>
      )}
    </CubeCamera>
  )),
  Hud: shows(() => (
    <Hud>
      <PerspectiveCamera makeDefault position={[0, 0, 5]} />
      <Box>
        <meshBasicMaterial />
      </Box>
    </Hud>
  )),
  View: shows(() => <View.Port />, {
    around: ({ children }) => (
      <>
        <View className="view">
          <color attach="background" args={['white']} />
        </View>
        {children}
      </>
    ),
    colors: [
      [180, 20, WHITE],
      [180, 140, BACKGROUND],
    ],
  }),

  Instances: shows(() => (
    <Instances>
      <boxGeometry />
      <meshBasicMaterial />
      <Instance position={RIGHT} color="lime" />
    </Instances>
  )),
  useGLTF: shows(() => <primitive object={useGLTF('triangle.glb').scene} position={RIGHT} />),
  useTexture: shows(() => (
    <Box>
      <meshBasicMaterial map={useTexture('green.png')} />
    </Box>
  )),
  useProgress: shows(() => <Box visible={useProgress().progress === 100} />),
  Loader: shows(() => <Box />, {
    around: ({ children }) => (
      <>
        {children}
        <Loader />
      </>
    ),
  }),
  Preload: shows(() => (
    <>
      <Box />
      <Preload all />
    </>
  )),
  Center: shows(() => (
    <group position={RIGHT}>
      <Center>
        <Box position={[9, 9, 9]} />
      </Center>
    </group>
  )),
  Resize: shows(() => (
    <group position={RIGHT}>
      <Resize>
        <Box position={[0, 0, 0]} scale={100} />
      </Resize>
    </group>
  )),
  Float: shows(() => (
    <Float>
      <Box />
    </Float>
  )),
  Stage: shows(() => (
    <Stage environment={null} adjustCamera={false}>
      <Box />
    </Stage>
  )),
  'Stage shadows={false}': instead(['Stage'], () => (
    <Stage environment={null} shadows={false} adjustCamera={false}>
      <Box />
    </Stage>
  )),
  RoundedBox: shows(() => <RoundedBox position={RIGHT} />),
  Detailed: shows(() => (
    <Detailed distances={[0, 100]} position={RIGHT}>
      <Box position={[0, 0, 0]} />
      <group />
    </Detailed>
  )),
  Bvh: shows(() => (
    <Bvh>
      <Box />
    </Bvh>
  )),
  CycleRaycast: shows(() => (
    <>
      <CycleRaycast />
      <Box />
    </>
  )),
  AdaptiveDpr: shows(() => (
    <>
      <AdaptiveDpr />
      <Box />
    </>
  )),
  AdaptiveEvents: shows(() => (
    <>
      <AdaptiveEvents />
      <Box />
    </>
  )),
  PerformanceMonitor: shows(() => (
    <>
      <PerformanceMonitor />
      <Box />
    </>
  )),
  Stats: shows(() => <Stats className="stats" />, {
    expects: 'holds',
    holds: () => document.querySelector('.stats canvas') !== null,
  }),
  PerspectiveCamera: shows(
    () => (
      <>
        <PerspectiveCamera makeDefault position={[0, 0, 4.5]} fov={50} />
        <Box />
      </>
    ),
    { coversSplats: true },
  ),
  OrthographicCamera: shows(
    () => (
      <>
        <OrthographicCamera makeDefault position={[0, 0, 5]} zoom={40} />
        <Box />
      </>
    ),
    { coversSplats: true },
  ),
};
