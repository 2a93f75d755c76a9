//! Writes the front of a measurement as a picture that one drags from quick to exact: at each point
//! the page shows the picture, its time and its error.

use std::fmt::Write as _;

use serde_json::json;

use super::page::escaped;
use super::report_page::{PagePicture, data};
use marraztu_lab::report::brief;

/// A point of the front, with its picture.
#[derive(Clone, Debug)]
pub struct FrontPicture {
    /// The milliseconds of the picture.
    pub ms: f64,
    /// The root mean square difference from the ideal, in byte steps.
    pub error: f64,
    /// The picture; its name tells the settings.
    pub picture: PagePicture,
}

/// The size of the plot, and the margin around its points.
const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 150.0;
const MARGIN: f64 = 26.0;

/// Writes the plot of the front with its slider; nothing if there is no choice.
pub(super) fn drag(front: &[FrontPicture]) -> String {
    if front.len() < 2 {
        return String::new();
    }
    let places = places(front);
    let mut plot = String::new();
    let line: Vec<String> = places.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
    let _ = write!(
        plot,
        "<polyline fill=\"none\" stroke=\"#0072b2\" stroke-width=\"2\" points=\"{}\"/>",
        line.join(" ")
    );
    for ([x, y], point) in places.iter().zip(front) {
        let _ = write!(
            plot,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" fill=\"#0072b2\">\
             <title>{}</title></circle>",
            escaped(&point.picture.name)
        );
    }
    let points: Vec<_> = places
        .iter()
        .zip(front)
        .map(|([x, y], point)| {
            json!({
                "x": x, "y": y, "url": data(&point.picture), "text": format!(
                    "{} ms a picture, error {} of 255: {}",
                    brief(point.ms), brief(point.error), point.picture.name
                ),
            })
        })
        .collect();
    // In a script, "</" would end it.
    let points = serde_json::Value::from(points).to_string().replace("</", "<\\/");
    format!(
        "<h2>From quick to exact</h2>\n<p>Drag the point, or move the slider: each step is worth \
         its time.</p>\n<svg id=\"front\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" \
         style=\"touch-action:none;cursor:pointer\" role=\"img\" \
         aria-label=\"Error against time, in powers of ten\">{plot}\
         <circle id=\"point\" r=\"8\" fill=\"#d55e00\"/>\
         <text x=\"4\" y=\"14\" font-size=\"12\" fill=\"currentColor\">error</text>\
         <text x=\"{WIDTH}\" y=\"{}\" font-size=\"12\" text-anchor=\"end\" \
         fill=\"currentColor\">time</text></svg>\n<input type=\"range\" id=\"at\" min=\"0\" \
         max=\"{}\" value=\"0\" aria-label=\"From quick to exact\">\n<p id=\"told\"></p>\n\
         <div class=\"pair\"><img id=\"shown\" alt=\"the picture of this point\"></div>\n\
         <script>{{const all={points},g=i=>document.getElementById(i),s=g('front');\
         const to=i=>{{const p=all[i];g('at').value=i;g('point').setAttribute('cx',p.x);\
         g('point').setAttribute('cy',p.y);g('told').textContent=p.text;g('shown').src=p.url}};\
         const near=e=>{{const r=s.getBoundingClientRect(),x=(e.clientX-r.left)*{WIDTH}/r.width;\
         to(all.reduce((b,p,i)=>Math.abs(p.x-x)<Math.abs(all[b].x-x)?i:b,0))}};\
         s.onpointerdown=e=>{{s.setPointerCapture(e.pointerId);near(e)}};\
         s.onpointermove=e=>{{if(e.buttons)near(e)}};\
         g('at').oninput=()=>to(+g('at').value);to(0)}}</script>\n",
        HEIGHT - 4.0,
        front.len() - 1,
    )
}

/// Returns the places of points in the plot: the logarithm of their time, and their error.
fn places(front: &[FrontPicture]) -> Vec<[f64; 2]> {
    let time = |point: &FrontPicture| libm::log10(point.ms.max(1e-3));
    let times = || front.iter().map(time);
    let (least, most) = (times().fold(f64::INFINITY, f64::min), times().fold(-9.0, f64::max));
    let largest = front.iter().map(|point| point.error).fold(1e-9, f64::max);
    let place = |point: &FrontPicture| {
        let across = (time(point) - least) / (most - least).max(1e-9);
        let down = 1.0 - point.error / largest;
        let within = |size: f64, part: f64| MARGIN + part * (size - 2.0 * MARGIN);
        [within(WIDTH, across), within(HEIGHT, down)]
    };
    front.iter().map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(ms: f64, error: f64, name: &str) -> FrontPicture {
        let picture =
            PagePicture { name: name.to_owned(), figures: String::new(), png: vec![1, 2, 3] };
        FrontPicture { ms, error, picture }
    }

    #[test]
    fn times_go_to_the_right_in_powers_of_ten_and_errors_up() {
        let front = [point(1.0, 8.0, "a"), point(10.0, 4.0, "b"), point(100.0, 0.0, "c")];
        let [a, b, c] = places(&front).try_into().unwrap();
        assert_eq!([a, c], [[MARGIN, MARGIN], [WIDTH - MARGIN, HEIGHT - MARGIN]]);
        assert!((b[0] - WIDTH / 2.0).abs() < 1e-9 && (b[1] - HEIGHT / 2.0).abs() < 1e-9, "{b:?}");
    }

    #[test]
    fn each_point_has_its_picture_and_figures_and_no_name_ends_the_script() {
        let text = drag(&[point(2.0, 3.0, "</script>"), point(9.5, 0.0, "ideal")]);
        assert_eq!(text.matches("data:image/png;base64,AQID").count(), 2);
        assert!(text.contains("2 ms a picture, error 3 of 255"), "{text}");
        assert_eq!(text.matches("</script>").count(), 1);
        assert_eq!(drag(&[point(2.0, 3.0, "alone")]), "");
    }
}
