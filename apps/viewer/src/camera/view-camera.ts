import { type Camera, perspectiveCamera } from '@websplatter/core';
import type { ViewerStore } from '../state/store.ts';
import { flippedPoint, flippedPose } from './flip.ts';
import { depthRange, FIRST_FOV_DEGREES, firstPose, framedPose, verticalFov } from './framing.ts';
import { OrbitControls, type OrbitControlsOptions } from './orbit-controls.ts';
import { orbitNear } from './orbit-near.ts';
import { focused, type LookAt, lookAt, type OrbitPose, poseFromLookAt } from './orbit-pose.ts';
import type { Sphere } from './scene-bounds.ts';
import type { Vec3 } from './vec3.ts';

/** The parts of a scene that its camera needs. */
export interface CameraSubject {
  /** Bounds of the scene without stray splats; unflipped. */
  readonly sphere: Sphere;
  /** Bounds of all splats, unflipped. */
  readonly extent: Sphere;
  /** Where to begin; null: at a distance from which all can be seen. */
  readonly firstView:
    | (LookAt & { readonly fovYDegrees: number; readonly near: number; readonly far: number })
    | null;
  /**
   * Cameras whose exact images the scene is about, by name, for an image of this aspect ratio. Orbiting need not be able
   * to reach them: they may be orthographic, off-centre or mirrored.
   */
  readonly ownCameras: ((aspect: number) => Readonly<Record<string, Camera>>) | null;
  /** Its y axis points down, as in captures that were solved with computer-vision conventions. */
  readonly isUpsideDown: boolean;
}

/** The camera's state, so that it can come back to it. */
export interface CameraSnapshot {
  readonly pose: OrbitPose;
  readonly home: OrbitPose;
  readonly fovDegrees: number;
  readonly cameraIndex: number;
  readonly isFlipped: boolean;
}

/** The camera of the scene that is shown: an orbit, or one of the scene's own cameras until the view is moved. */
export class ViewCamera {
  readonly controls: OrbitControls;
  readonly #store: ViewerStore;
  #subject: CameraSubject | null = null;
  /** Field of view over the image's shorter side while the camera orbits. */
  #fovDegrees = FIRST_FOV_DEGREES;

  constructor(store: ViewerStore, options: OrbitControlsOptions) {
    this.#store = store;
    this.controls = new OrbitControls(options);
  }

  /** Looks at `subject` from now on; the pose stays until `showFirstView` or `restore`. */
  follow(subject: CameraSubject): void {
    this.#subject = subject;
    const { radius } = subject.sphere;
    this.controls.distanceRange = { min: radius * 1e-3, max: radius * 100 };
  }

  showFirstView(): void {
    const subject = this.#subject;
    if (!subject) return;
    const { firstView, ownCameras, sphere, isUpsideDown } = subject;
    this.#store.setState({ isFlipped: isUpsideDown, cameraIndex: 0 });
    if (ownCameras) {
      this.#showOwnCamera(0);
      return;
    }
    this.#fovDegrees = firstView?.fovYDegrees ?? FIRST_FOV_DEGREES;
    const pose = firstView
      ? poseFromLookAt(firstView)
      : firstPose(this.#placed(sphere), this.#fovYDegrees, this.#aspect);
    this.controls.setPose(pose);
  }

  /** After `follow`, shows the first view of a scene of which more has become known, unless the view has been moved. */
  showFirstViewAgain(): void {
    const subject = this.#subject;
    if (!subject || !this.controls.isHome) return;
    this.controls.setPose(firstPose(this.#placed(subject.sphere), this.#fovYDegrees, this.#aspect));
  }

  snapshot(): CameraSnapshot {
    const { pose, home } = this.controls;
    const { isFlipped, cameraIndex } = this.#store.getState();
    return { pose, home, fovDegrees: this.#fovDegrees, cameraIndex, isFlipped };
  }

  restore({ pose, home, fovDegrees, cameraIndex, isFlipped }: CameraSnapshot): void {
    this.#fovDegrees = fovDegrees;
    this.#store.setState({ cameraIndex, isFlipped });
    this.controls.setPose(pose, home);
  }

  /** Glides `elapsedMs` further; returns whether it has not arrived, so that another frame is needed. */
  update(elapsedMs: number): boolean {
    this.controls.fovYDegrees = this.#fovYDegrees;
    return this.controls.update(elapsedMs);
  }

  /** The scene's own camera for this shape of the image, unless the view has been moved away from it. */
  get ownCamera(): Camera | undefined {
    return this.controls.isHome ? this.#ownCameraAt(this.#store.getState().cameraIndex) : undefined;
  }

  /** The camera that shows the pose of the controls. */
  get orbitCamera(): Camera {
    const subject = this.#subject;
    if (!subject) throw new Error('The camera has no scene to look at.');
    const { pose, fovYDegrees } = this.controls;
    const { near, far } =
      subject.firstView ?? depthRange(pose, this.#placed(subject.sphere), this.#placed(subject.extent));
    return perspectiveCamera({ ...lookAt(pose), fovYDegrees, aspect: this.#aspect, near, far });
  }

  /** Names of the scene's own cameras. */
  get ownCameraNames(): readonly string[] {
    return Object.keys(this.#ownCameras());
  }

  /** Turns the scene the other way up; the view keeps facing the same side of it. */
  toggleFlip(): void {
    if (!this.#store.getState().scene?.canFlip) return;
    this.#store.setState(({ isFlipped }) => ({ isFlipped: !isFlipped }));
    this.controls.setPose(flippedPose(this.controls.pose), flippedPose(this.controls.home));
  }

  /** Moves the camera, without turning it, so that the whole scene can be seen. */
  frameScene(): void {
    const { controls } = this;
    const subject = this.#subject;
    if (!subject) return;
    controls.glideTo(
      framedPose(controls.pose, this.#placed(subject.sphere), controls.fovYDegrees, this.#aspect),
    );
  }

  /** Brings `point`, of the scene as it is drawn, to the middle of the image, and turns around it from then on. */
  focus(point: Vec3): void {
    const { controls } = this;
    controls.glideTo(focused(controls.pose, point, controls.distanceRange));
  }

  /** Shows the scene's next own camera, or with −1 the one before. */
  step(by: 1 | -1): void {
    const { scene, cameraIndex } = this.#store.getState();
    const count = scene?.cameras.length ?? 0;
    if (count > 0) this.#showOwnCamera((cameraIndex + by + count) % count);
  }

  /** Moves the view by the key that was pressed; returns whether the key means anything here. */
  handleKey(event: KeyboardEvent): boolean {
    if (event.key !== '[' && event.key !== ']') return this.controls.handleKey(event);
    this.step(event.key === ']' ? 1 : -1);
    return true;
  }

  /** Shows an own camera of the scene; moving goes on as an orbit from about there. */
  #showOwnCamera(index: number): void {
    const subject = this.#subject;
    const camera = this.#ownCameraAt(index);
    if (!subject || !camera) return;
    const { pose, fovDegrees } = orbitNear(camera, subject.sphere, this.#aspect);
    this.#fovDegrees = fovDegrees;
    this.#store.setState({ cameraIndex: index });
    this.controls.setPose(pose);
  }

  #ownCameras(): Readonly<Record<string, Camera>> {
    return this.#subject?.ownCameras?.(this.#aspect) ?? {};
  }

  #ownCameraAt(index: number): Camera | undefined {
    return Object.values(this.#ownCameras())[index];
  }

  get #fovYDegrees(): number {
    return verticalFov(this.#fovDegrees, this.#aspect);
  }

  get #aspect(): number {
    const { widthPx, heightPx } = this.#store.getState();
    return widthPx > 0 ? widthPx / heightPx : 1;
  }

  /** `sphere` in the scene as it is drawn: flipped or not. */
  #placed(sphere: Sphere): Sphere {
    const { isFlipped } = this.#store.getState();
    return isFlipped ? { center: flippedPoint(sphere.center), radius: sphere.radius } : sphere;
  }
}
