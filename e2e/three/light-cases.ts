import {
  AmbientLight,
  DirectionalLight,
  HemisphereLight,
  type Light,
  Mesh,
  MeshLambertMaterial,
  PlaneGeometry,
  PointLight,
  SpotLight,
} from 'three/webgpu';
import { splatCloud } from './splats.ts';
import { areOn, meshShot, newStage, type Pixels, shot, shotWith, until } from './stage.ts';

/** Each of three's lights that splats take, beside the axis to the eye. */
const LIGHTS = {
  ambient: () => new AmbientLight(0xffcc88, 2),
  hemisphere: () => new HemisphereLight(0xffffff, 0x3355ff, 2),
  directional: () => new DirectionalLight(0xffeedd, 3),
  point: () => new PointLight(0xff8844, 14, 9, 1.6),
  spot: () => new SpotLight(0xffffff, 15, 0, 0.5, 0.8),
} as const satisfies Readonly<Record<string, () => Light>>;

type LightName = keyof typeof LIGHTS;

export const lightCases = {
  /** A flat white splat and a white mesh in its place, each in the light and in the moved light. */
  relit: async (name: LightName) => {
    const stage = await newStage();
    const { scene, renderer } = stage;
    const light = LIGHTS[name]();
    scene.add(light);
    const cloud = splatCloud({ opacity: 0.9999 });
    cloud.relight = 1;
    const mesh = new Mesh(new PlaneGeometry(9, 9), new MeshLambertMaterial());
    const places = [
      [0.8, 1.5, 2],
      [-0.4, 0.3, 2.5],
    ] as const;
    const lit: { splat: Pixels; mesh: Pixels }[] = [];
    for (const place of places) {
      light.position.fromArray(place);
      scene.add(cloud);
      const splat = await shotWith(stage, { relight: true });
      scene.remove(cloud);
      scene.add(mesh);
      lit.push({ splat, mesh: await meshShot(stage) });
      scene.remove(mesh);
    }
    scene.add(cloud);
    await shot(stage);
    cloud.relight = 0;
    await until(() => {
      renderer.render(scene, stage.camera);
      return !areOn(renderer, { relight: true });
    });
    return { lit, without: await shot(stage) };
  },
};
