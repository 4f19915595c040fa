//! The renderer of KeKsBoTer/web-splat on a page's canvas; its own web entry keeps to a window.

use cgmath::{Matrix3, Point3, Quaternion, Rad, Vector2};
use std::{io::Cursor, time::Duration};
use wasm_bindgen::prelude::*;
use web_splats::{
    io::GenericGaussianPointCloud, GaussianRenderer, PerspectiveCamera, PerspectiveProjection,
    PointCloud, SplattingArgs, WGPUContext,
};
use web_sys::HtmlCanvasElement;

/// As its viewer blends splats.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

#[wasm_bindgen]
pub struct CanvasRenderer {
    context: WGPUContext,
    surface: wgpu::Surface<'static>,
    renderer: GaussianRenderer,
    cloud: PointCloud,
    viewport: Vector2<u32>,
    camera: PerspectiveCamera,
}

#[wasm_bindgen]
impl CanvasRenderer {
    /// Uploads the splats of a PLY.
    pub async fn load(canvas: HtmlCanvasElement, ply: Vec<u8>) -> Result<CanvasRenderer, JsError> {
        let viewport = Vector2::new(canvas.width(), canvas.height());
        let instance = wgpu::Instance::new(&wgpu::InstanceDescriptor::default());
        let surface = instance.create_surface(wgpu::SurfaceTarget::Canvas(canvas))?;
        let context = WGPUContext::new(&instance, Some(&surface)).await;
        let configuration = wgpu::SurfaceConfiguration {
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
            format: FORMAT,
            width: viewport.x,
            height: viewport.y,
            desired_maximum_frame_latency: 2,
            present_mode: wgpu::PresentMode::AutoNoVsync,
            alpha_mode: wgpu::CompositeAlphaMode::Opaque,
            view_formats: vec![],
        };
        surface.configure(&context.device, &configuration);
        let splats = GenericGaussianPointCloud::load(Cursor::new(ply)).map_err(in_words)?;
        let cloud = PointCloud::new(&context.device, splats).map_err(in_words)?;
        let (degree, is_compressed) = (cloud.sh_deg(), cloud.compressed());
        let renderer =
            GaussianRenderer::new(&context.device, &context.queue, FORMAT, degree, is_compressed)
                .await;
        let camera = PerspectiveCamera::default();
        Ok(CanvasRenderer { context, surface, renderer, cloud, viewport, camera })
    }

    /// `rotation`: world to right, down and forward, column-major; fields of view in radians.
    pub fn set_camera(
        &mut self,
        position: &[f32],
        rotation: &[f32],
        fov_x: f32,
        fov_y: f32,
        near: f32,
        far: f32,
    ) {
        let [p, r] = [position, rotation];
        let fov = Vector2::new(Rad(fov_x), Rad(fov_y));
        self.camera = PerspectiveCamera::new(
            Point3::new(p[0], p[1], p[2]),
            Quaternion::from(Matrix3::new(
                r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8],
            )),
            PerspectiveProjection::new(self.viewport, fov, near, far),
        );
    }

    /// Sorts and draws one frame.
    pub fn render(&mut self) -> Result<(), JsError> {
        let WGPUContext { device, queue, .. } = &self.context;
        let frame = self.surface.get_current_texture()?;
        let view = frame.texture.create_view(&wgpu::TextureViewDescriptor::default());
        let mut encoder = device.create_command_encoder(&Default::default());
        let settings = SplattingArgs {
            camera: self.camera,
            viewport: self.viewport,
            gaussian_scaling: 1.0,
            max_sh_deg: self.cloud.sh_deg(),
            mip_splatting: None,
            kernel_size: None,
            clipping_box: None,
            // Long after the start, when its viewer has faded all splats in.
            walltime: Duration::from_secs(100),
            scene_center: None,
            scene_extend: None,
            background_color: wgpu::Color::BLACK,
        };
        self.renderer.prepare(&mut encoder, device, queue, &self.cloud, settings, &mut None);
        {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &view,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                ..Default::default()
            });
            self.renderer.render(&mut pass, &self.cloud);
        }
        queue.submit([encoder.finish()]);
        frame.present();
        Ok(())
    }

    pub fn splats(&self) -> u32 {
        self.cloud.num_points()
    }
}

fn in_words(error: impl std::fmt::Display) -> JsError {
    JsError::new(&error.to_string())
}
