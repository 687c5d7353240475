// One canvas with the parts of a job: turned by pointer and keys, drawn only when something changes.
import { Box3, DirectionalLight, HemisphereLight, PerspectiveCamera, Raycaster, Scene as Space, Spherical, Vector2, Vector3, WebGLRenderer } from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { DrawnPart } from './drawn_part';
import { Plates } from './plate';
import { inScene, Way } from './way';
import type { ScenePart } from './parts';
import type { PackedReport } from '../daemon/types';
import type { Looks } from '../job/looks';

const FROM = new Spherical(1, 1.08, 0.5);  // where it is looked at from first
const TURN = 0.16;                         // radians a key press
const ZOOM = 1.15;
const CLICK_PX = 5;
const SETTLE_S = 0.11;  // in which a move does about two thirds of what is left
const LIFT = 1.4;    // of the tray's height
const MARGIN = 1.12;
const SURROUNDINGS = 0.45;  // of the plate around the parts

const NOT_SET = 1e-4;  // the camera's near plane before it looks at anything

const isCalm = (): boolean => matchMedia('(prefers-reduced-motion: reduce)').matches;

// The plates' ground.
function footprint(report: PackedReport): Box3 {
  const [width, depth] = report.printer.build_mm;
  return new Box3().setFromPoints([inScene([0, 0, 0]), inScene([width, depth, 0])]);
}

// Part of the way to what is around it, so that it is seen how much of the plate is used.
function widen(box: Box3, around: Box3): void {
  const { min, max } = box.clone().union(around);
  box.min.lerp(min, SURROUNDINGS);
  box.max.lerp(max, SURROUNDINGS);
}

export class Scene {
  private readonly renderer: WebGLRenderer;
  private readonly space = new Space();
  private readonly camera = new PerspectiveCamera(30, 1, NOT_SET, 50);
  private readonly controls: OrbitControls;
  private readonly parts: DrawnPart[];
  private readonly plates: Plates | null;
  private readonly sizes: ResizeObserver;
  private readonly away = new AbortController();
  private frame = 0;
  private before_ms = 0;
  private moving = false;

  // Throws where the browser has no WebGL. With a report the parts stand on its trays.
  constructor(private readonly canvas: HTMLCanvasElement, parts: ScenePart[],
              private readonly pick: (id: number | null) => void, report?: PackedReport) {
    this.renderer = new WebGLRenderer({ canvas, alpha: true, antialias: true });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    const box = parts.reduce((all, part) => all.expandByObject(part.mesh), new Box3());
    const lift = LIFT * box.getSize(new Vector3()).y + 0.02;
    this.parts = parts.map(({ id, mesh }) =>
      new DrawnPart(id, mesh, report ? new Way(report.removal_path?.[String(id)] ?? [], lift) : null));
    this.plates = report ? new Plates(report.printer, Math.max(...report.parts.map((part) => part.tray))) : null;
    this.space.add(...parts.map((part) => part.mesh));
    if (this.plates) this.space.add(this.plates);
    this.light();
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = false;
    this.controls.enableZoom = false;
    canvas.style.touchAction = 'pan-y';  // a finger that goes up or down scrolls the page
    if (report) widen(box, footprint(report));
    this.listen();
    this.sizes = new ResizeObserver(() => this.resize(box));
    this.sizes.observe(canvas);
    this.recolour();
  }

  show(looks: Looks): void {
    for (const part of this.parts) part.show(looks.get(part.id) ?? 'solid');
    this.moving = true;
    this.before_ms = performance.now();
    this.draw();
  }

  recolour(): void {
    this.plates?.colour(getComputedStyle(this.canvas).color);
    this.draw();
  }

  close(): void {
    cancelAnimationFrame(this.frame);
    this.away.abort();
    this.sizes.disconnect();
    this.controls.dispose();
    for (const part of this.parts) part.mesh.geometry.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }

  private light(): void {
    const lamp = new DirectionalLight(0xffffff, 2.1);
    lamp.position.set(-0.6, 0.9, 1);
    this.camera.add(lamp);
    this.space.add(this.camera, new HemisphereLight(0xffffff, 0x8d8a86, 1.5));
  }

  // As near as all of the box is in sight.
  private lookAt(box: Box3): void {
    const { target } = this.controls;
    box.getCenter(target);
    const look = new Vector3().setFromSpherical(FROM);
    const right = new Vector3(0, 1, 0).cross(look).normalize();
    const up = look.clone().cross(right);
    const slope = Math.tan((this.camera.fov * Math.PI) / 360) / MARGIN;
    let distance = 0;
    for (let corner = 0; corner < 8; corner += 1) {
      const at = new Vector3(corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                             corner & 4 ? box.max.z : box.min.z).sub(target);
      const needed = Math.max(Math.abs(at.dot(up)), Math.abs(at.dot(right)) / this.camera.aspect) / slope;
      distance = Math.max(distance, at.dot(look) + needed);
    }
    this.camera.position.copy(look.multiplyScalar(distance)).add(target);
    this.camera.near = distance / 100;
    this.camera.far = distance * 40;
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.controls.saveState();
  }

  private listen(): void {
    const options = { signal: this.away.signal };
    let down = new Vector2(NaN, NaN);
    this.controls.addEventListener('change', () => this.draw());
    // the wheel scrolls the page until somebody has turned to the picture
    this.canvas.addEventListener('focus', () => { this.controls.enableZoom = true; }, options);
    this.canvas.addEventListener('blur', () => { this.controls.enableZoom = false; }, options);
    this.canvas.addEventListener('keydown', (event) => this.press(event), options);
    this.canvas.addEventListener('pointerdown', (event) => {
      down = new Vector2(event.clientX, event.clientY);
      this.canvas.focus({ preventScroll: true });
    }, options);
    this.canvas.addEventListener('pointerup', (event) => {
      if (down.distanceTo(new Vector2(event.clientX, event.clientY)) < CLICK_PX) this.pick(this.partAt(event));
    }, options);
  }

  private partAt(event: PointerEvent): number | null {
    const frame = this.canvas.getBoundingClientRect();
    const ray = new Raycaster();
    ray.setFromCamera(new Vector2((2 * (event.clientX - frame.left)) / frame.width - 1,
                                  1 - (2 * (event.clientY - frame.top)) / frame.height), this.camera);
    const near = (parts: DrawnPart[]): number | undefined => {
      const hit = ray.intersectObjects(parts.map((part) => part.mesh), false)[0];
      return parts.find((part) => part.mesh === hit?.object)?.id;
    };
    return near(this.parts.filter((part) => part.solid)) ?? near(this.parts.filter((part) => part.present)) ?? null;
  }

  private press(event: KeyboardEvent): void {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const at = new Spherical().setFromVector3(this.camera.position.clone().sub(this.controls.target));
    switch (event.key) {
      case 'ArrowLeft': at.theta -= TURN; break;
      case 'ArrowRight': at.theta += TURN; break;
      case 'ArrowUp': at.phi -= TURN; break;
      case 'ArrowDown': at.phi += TURN; break;
      case '+': case '=': at.radius /= ZOOM; break;
      case '-': at.radius *= ZOOM; break;
      case 'Home': event.preventDefault(); return this.controls.reset();
      default: return;
    }
    event.preventDefault();
    this.camera.position.setFromSpherical(at.makeSafe()).add(this.controls.target);
    this.controls.update();
    this.draw();
  }

  private resize(box: Box3): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (width === 0 || height === 0) return;
    const isFirst = this.camera.near === NOT_SET;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    if (isFirst) this.lookAt(box);
    this.draw();
  }

  private draw(): void {
    cancelAnimationFrame(this.frame);
    this.frame = requestAnimationFrame((now_ms) => {
      if (this.moving) this.move(now_ms);
      this.renderer.render(this.space, this.camera);
      if (this.moving) this.draw();
    });
  }

  private move(now_ms: number): void {
    const passed_s = Math.max(0, now_ms - this.before_ms) / 1000;
    this.before_ms = now_ms;
    const fraction = isCalm() ? 1 : 1 - Math.exp(-passed_s / SETTLE_S);
    this.moving = this.parts.map((part) => part.step(fraction)).includes(true);
  }
}
