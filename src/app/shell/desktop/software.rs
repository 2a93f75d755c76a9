//! The window painted by the CPU: the event loop.
//!
//! It does the same as eframe, with the same libraries winit and egui-winit, for the editor's one
//! window. It sleeps until an event arrives or the editor requests a repaint.

use egui::ViewportBuilder;
use winit::application::ApplicationHandler;
use winit::event::{DeviceEvent, DeviceId, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy};
use winit::window::WindowId;

use super::window::{Flow, Wake, Window};
use super::{Make, StartError, display_error};

pub(super) fn run(builder: ViewportBuilder, make: Make) -> Result<(), StartError> {
    let event_loop = EventLoop::with_user_event().build().map_err(|error| display_error(&error))?;
    let proxy = event_loop.create_proxy();
    let mut shell = Software { proxy, beginning: Some((builder, make)), window: None, end: None };
    event_loop.run_app(&mut shell).map_err(|error| display_error(&error))?;
    shell
        .end
        .unwrap_or_else(|| Err(StartError::Lost("the display connection was closed".to_owned())))
}

struct Software {
    proxy: EventLoopProxy<Wake>,
    /// The arguments for opening the window, until it is open.
    beginning: Option<(ViewportBuilder, Make)>,
    window: Option<Window>,
    end: Option<Result<(), StartError>>,
}

impl Software {
    fn end(&mut self, event_loop: &ActiveEventLoop, end: Result<(), StartError>) {
        self.end.get_or_insert(end);
        self.window = None;
        event_loop.exit();
    }

    fn follow(&mut self, event_loop: &ActiveEventLoop, flow: Result<Flow, StartError>) {
        match flow {
            Ok(Flow::On) => {}
            Ok(Flow::Left) => {
                if let Some(window) = &mut self.window {
                    window.leave();
                }
                self.end(event_loop, Ok(()));
            }
            Err(error) => self.end(event_loop, Err(error)),
        }
    }
}

impl ApplicationHandler<Wake> for Software {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        let Some((builder, make)) = self.beginning.take() else { return };
        match Window::open(event_loop, builder, self.proxy.clone(), make) {
            Ok(window) => self.window = Some(window),
            Err(error) => self.end(event_loop, Err(error)),
        }
    }

    fn user_event(&mut self, _: &ActiveEventLoop, event: Wake) {
        let Some(window) = &mut self.window else { return };
        match event {
            Wake::Repaint { at, pass } => window.wake(at, pass),
            Wake::Access(event) => window.hear_screen_reader(event.window_event),
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(window) = &mut self.window else { return };
        match event {
            WindowEvent::RedrawRequested => {
                let flow = window.redraw(event_loop);
                self.follow(event_loop, flow);
            }
            WindowEvent::Destroyed => {
                self.end(event_loop, Err(StartError::Lost("it was destroyed".to_owned())));
            }
            event => window.hear(&event),
        }
    }

    fn device_event(&mut self, _: &ActiveEventLoop, _: DeviceId, event: DeviceEvent) {
        if let (Some(window), DeviceEvent::MouseMotion { delta }) = (&mut self.window, event) {
            window.hear_motion(delta);
        }
    }

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        let Some(window) = &mut self.window else { return };
        let flow = window.frame_if_due(event_loop);
        self.follow(event_loop, flow);
        let next = self.window.as_ref().and_then(Window::next);
        event_loop.set_control_flow(next.map_or(ControlFlow::Wait, ControlFlow::WaitUntil));
    }
}
